"""Read CSV files of numbers: recorded runs and measurements."""

from typing import TYPE_CHECKING

from somo_cli import files
from somo_cli.problems import InvalidFile, Problem

if TYPE_CHECKING:
    from somo_cli.document.table import Table

SMALLEST = 1e-100  # in any unit
MAX_TABLE_BYTES = 500_000_000
"""The largest CSV that commands read [bytes]."""


def read_table_file(path: str) -> "Table":
    """Return a CSV of numbers. Raises OSError and InvalidFile."""
    from somo_cli.document.table import read_table

    return read_table(files.read_text(path, MAX_TABLE_BYTES), path)


def read_measurements(path: str) -> "Table":
    """Return a CSV of measured numbers; a column of nothing but tiny ones is refused.

    Squares of numbers below `SMALLEST` leave the range of floats, and no sensor tells them from
    zero. Raises OSError and InvalidFile.
    """
    table = read_table_file(path)
    problems = [
        Problem(
            table.header_span(name),
            f"the numbers of '{name}' are too small: none is above {SMALLEST:g}",
            "check the unit in which they were written",
        )
        for name, values in table.columns.items()
        if 0 < max(map(abs, values)) < SMALLEST
    ]
    if problems:
        raise InvalidFile(problems, table.texts)
    return table
