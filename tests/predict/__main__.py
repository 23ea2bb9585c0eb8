"""Print what runs tell of their error, and what was expected of them, over what is true.

`make predict`; some minutes.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

from tests.predict.cases import cases
from tests.predict.judge import Told, judged


def main() -> None:
    """Print one row for each case, and the shares of all."""
    with ProcessPoolExecutor(initializer=_hush) as processes:
        found = list(processes.map(judged, cases()))
    print("worst error of a kind of column over its range: told by --error, true, told over true")
    print(f"{'':28}{'contact':>8}{'told':>9}{'true':>9}{'least':>8}{'most':>8}  tip expected")
    for one in found:
        print(_row(one))
    for name, has_contact in (("free motion", False), ("contact", True)):
        ratios = [ratio for one in found if one.has_contact == has_contact for ratio in one.ratios]
        print(f"{name}: {_shares(ratios)}")


def _row(one: Told) -> str:
    start = f"{one.name:28}{'yes' if one.has_contact else 'no':>8}"
    if not one.told:
        return f"{start}  {one.end}"
    least, most = min(one.ratios, default=float("nan")), max(one.ratios, default=float("nan"))
    return (
        f"{start}{max(one.told):9.1e}{max(one.true):9.1e}{least:8.2f}{most:8.2f}  "
        f"{one.expected:.1e}"
    )


def _shares(ratios: Sequence[float]) -> str:
    """Return how many ratios are within 1.5 and 3, and how many told too little."""
    count = max(1, len(ratios))
    within = [sum(1 / factor <= one <= factor for one in ratios) / count for factor in (1.5, 3)]
    little = sum(one < 1 / 1.5 for one in ratios) / count
    return (
        f"{len(ratios)} errors; {within[0]:.0%} within a factor of 1.5, {within[1]:.0%} within 3, "
        f"{little:.0%} told less than two thirds of the true one"
    )


def _hush() -> None:
    """Drop what the engine prints."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


if __name__ == "__main__":
    main()
