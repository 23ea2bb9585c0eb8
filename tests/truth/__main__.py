"""Print every table of truth: `make truth`; with -o FILE the rows go to a CSV as well."""

from __future__ import annotations

import argparse
import csv
import dataclasses
import itertools
from pathlib import Path

from tests.truth import (
    against_mujoco,
    beams,
    calibrated,
    estimates,
    fitted,
    motion,
    prescribed,
    shapes,
    surfaces,
    touching,
)
from tests.truth.table import lines


def main() -> None:
    """Print the tables, section by section."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("-o", "--output", metavar="FILE", type=Path)
    options = arguments.parse_args()
    found = []
    sections = (
        beams,
        calibrated,
        fitted,
        motion,
        estimates,
        touching,
        surfaces,
        shapes,
        prescribed,
    )
    for section in (one.rows for one in sections):
        for _, part in itertools.groupby(section(), key=lambda row: row.what):
            rows = list(part)
            found += rows
            print(*lines(rows), sep="\n", flush=True)
    against_mujoco.main([])
    if options.output is not None:
        with options.output.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow([field.name for field in dataclasses.fields(found[0])])
            writer.writerows(dataclasses.astuple(row) for row in found)


if __name__ == "__main__":
    main()
