"""The rows of the table, and how they are printed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

ROUNDING = 1e-12  # errors below it have no order


@dataclass(frozen=True)
class Row:
    """One figure: what it is, of which case, at which number of joints or step, and how far off.

    The order is that in which the error fell from the row before.
    """

    what: str
    case: str
    at: str
    ours: float
    reference: float
    error: float
    order: float = math.nan


def ordered(rows: Sequence[Row], sizes: Sequence[float]) -> list[Row]:
    """Return the rows with their orders, the sizes being those of a joint's share or of a step."""
    found = [rows[0]]
    for index in range(1, len(rows)):
        before, after = rows[index - 1].error, rows[index].error
        order = math.nan
        if min(before, after) > ROUNDING:
            order = math.log(before / after) / math.log(sizes[index - 1] / sizes[index])
        found.append(replace(rows[index], order=order))
    return found


def lines(rows: Iterable[Row]) -> Iterator[str]:
    """Yield the table, a line for each row, with a title where what is measured changes."""
    what = ""
    for row in rows:
        if row.what != what:
            what = row.what
            yield f"\n{what}"
            yield _line("case", "at", "ours", "reference", "error", "order")
        order = "" if math.isnan(row.order) else f"{row.order:.2f}"
        numbers = f"{row.ours:.9g}", f"{row.reference:.9g}", f"{row.error:.1e}"
        yield _line(row.case, row.at, *numbers, order)


def _line(case: str, at: str, ours: str, reference: str, error: str, order: str) -> str:
    line = f"  {case:26} {at:>12} {ours:>16} {reference:>16} {error:>9} {order:>6}"
    return line.rstrip()
