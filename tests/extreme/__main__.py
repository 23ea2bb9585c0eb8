"""Run every case and compare the matrix with the committed one: `make extreme`.

With --rewrite the matrix is written anew; with words, only the cases with one of them in their
name are run, and nothing is compared.
"""

from __future__ import annotations

import argparse
import difflib
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tests.extreme.case import read_cases
from tests.extreme.verdict import matrix, summary, verdict

MATRIX = Path(__file__).with_name("matrix.txt")


def main() -> int:
    """Return the exit code: 1 if the matrix is not the committed one."""
    parser = argparse.ArgumentParser(prog="tests.extreme", description=__doc__)
    parser.add_argument("words", nargs="*")
    parser.add_argument("--rewrite", action="store_true")
    asked = parser.parse_args()
    cases = [
        case
        for case in read_cases()
        if not asked.words or any(word in case.name for word in asked.words)
    ]
    with ProcessPoolExecutor(initializer=_hush) as processes:
        verdicts = list(processes.map(verdict, cases))
    found = matrix(verdicts) + "\n" + summary(verdicts)
    print(found, end="")
    if asked.words:
        return 0
    if asked.rewrite:
        MATRIX.write_text(found, "utf-8")
        return 0
    difference = list(
        difflib.unified_diff(
            MATRIX.read_text("utf-8").splitlines(keepends=True),
            found.splitlines(keepends=True),
            "committed",
            "found",
        )
    )
    sys.stdout.writelines(["\n", *difference] if difference else [])
    return int(bool(difference))


def _hush() -> None:
    """Drop the messages of the engine: the matrix has what it refused."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


if __name__ == "__main__":
    sys.exit(main())
