"""Read CSV files of numbers: recorded runs and measurements."""

from typing import TYPE_CHECKING

from somo_cli import files

if TYPE_CHECKING:
    from somo_cli.document.table import Table

MAX_TABLE_BYTES = 500_000_000
"""The largest CSV that commands read [bytes]."""


def read_table_file(path: str) -> "Table":
    """Return a CSV of numbers. Raises OSError and InvalidFile."""
    from somo_cli.document.table import read_table

    return read_table(files.read_text(path, MAX_TABLE_BYTES), path)
