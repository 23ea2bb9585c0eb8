"""Read CSV files of numbers: recorded runs and measurements."""

from typing import TYPE_CHECKING

from somo_cli import files, terminal
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
    """Return a CSV of measured numbers in SI; a column of nothing but tiny ones is refused.

    Columns in kPa, mN, mm, degrees and such are converted, which is said.

    Squares of numbers below `SMALLEST` leave the range of floats, and no sensor tells them from
    zero. Raises OSError and InvalidFile.
    """
    from somo_cli.document.table_units import in_si

    table, converted = in_si(read_table_file(path))
    for text in converted:
        terminal.print_message(f"somo: {path}: {text}")
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
