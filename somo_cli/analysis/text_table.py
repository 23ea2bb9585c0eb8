"""Rows of cells as lines of text, the one way in which tables are printed."""

from __future__ import annotations

import re
from collections.abc import Sequence

ROUNDING = 1e-14
"""Relative to the numbers of a sum: some fifty times the spacing of floats."""

_SIGNED_ZERO = re.compile(r"^[-+](0(?:\.0*)?(?:e[-+]00)?)(?=$|\s)")


def table_lines(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return one line for each row, with columns as wide as their widest cell.

    The first column is aligned to the left, all others to the right. A row may be shorter than
    others; an empty row is an empty line. Zero has no sign.
    """
    rows = [[_SIGNED_ZERO.sub(r"\1", cell) for cell in row] for row in rows]
    count = max(map(len, rows), default=0)
    widths = [max(len(row[column]) for row in rows if column < len(row)) for column in range(count)]
    return [_line(row, widths) for row in rows]


def without_rounding(value: float, size: float) -> float:
    """Return a value, or zero if it is no more than the rounding of numbers of this size.

    For what is printed alone: files have every number as it was computed.
    """
    return value if abs(value) > ROUNDING * size else 0.0


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    cells = [
        cell.ljust(width) if column == 0 else cell.rjust(width)
        for column, (cell, width) in enumerate(zip(row, widths, strict=False))
    ]
    return "  ".join(cells).rstrip()
