"""Print what runs tell of their error, what a tolerance brings, and what contact steps are needed.

`make predict`; some minutes. `python -m tests.predict errors tolerance steps` prints the tables
that are named, and all without a name.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor

from somo_cli.analysis.verdict import percent
from tests.predict.cases import cases, striking, to_tolerance, with_contact
from tests.predict.contact_step import Ladder, climbed
from tests.predict.judge import Told, judged
from tests.predict.tolerance import ASKED, Kept, kept


def main(names: Sequence[str]) -> None:
    """Print the tables with these names, or all."""
    for name in names or TABLES:
        with ProcessPoolExecutor(initializer=_hush) as processes:
            TABLES[name](processes)


def _errors(processes: ProcessPoolExecutor) -> None:
    """Print one row for each case, and the shares of each kind of case."""
    found = list(processes.map(judged, cases()))
    limits = list(processes.map(judged, striking()))
    print("worst error of a kind of column over its range: told by --error, true, told over true")
    print(f"{'':28}{'contact':>8}{'told':>9}{'true':>9}{'least':>8}{'most':>8}  tip expected")
    for one in (*found, *limits):
        print(_row(one))
    free = [one for one in found if not one.has_contact]
    touching = [one for one in found if one.has_contact]
    kinds = ("free motion", free), ("joints strike their limits", limits), ("contact", touching)
    for name, group in kinds:
        print(f"{name}: {_shares([ratio for one in group for ratio in one.ratios])}")
    converged = [one for one in (*found, *limits) if one.is_told_converged]
    elsewhere = sum(one.is_elsewhere for one in converged)
    print(f"{len(converged)} runs are told to be converged; {elsewhere} have another outcome")


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


def _tolerance(processes: ProcessPoolExecutor) -> None:
    """Print what --tolerance asked, told and cost on ten scenes, and what is true."""
    print("worst error over the range of a column; cost over that of a run at the scene's own step")
    head = f"{'':24}{'contact':>8}{'asked':>8}{'told':>10}{'true':>10}{'step [s]':>10}{'cost':>7}"
    print(head)
    for one in processes.map(kept, to_tolerance()):
        print(_kept_row(one), flush=True)


def _kept_row(one: Kept) -> str:
    start = f"{one.name:24}{'yes' if one.has_contact else 'no':>8}{ASKED:8.0%}"
    if one.end == "diverged":
        return f"{start}  {one.end}"
    return (
        f"{start}{percent(one.told):>10}{percent(one.true):>10}{one.time_step:10.3g}{one.cost:7.1f}"
        f"{'' if one.end == 'converged' else '  ' + one.end}"
    )


def _steps(processes: ProcessPoolExecutor) -> None:
    """Print how many times finer than needed the recommended step of contact scenes is."""
    print(
        "worst error at the recommended step over the largest range in its unit or the scene's "
        "size,\nand how many times finer that step is than the largest that holds: no finding, "
        "within 1 % of the finest"
    )
    print(f"{'':42}{'step [s]':>10}{'error':>9}{'times':>7}")
    found = []
    for one in processes.map(climbed, with_contact()):
        print(_ladder_row(one), flush=True)
        found.append(one)
    settled = [one for one in found if one.is_settled]
    fine = sum(one.times_too_fine <= 4 for one in settled)
    coarse = sum(one.times_too_fine < 1 for one in settled)
    print(
        f"{len(settled)} of {len(found)} are settled; of these {fine / max(1, len(settled)):.0%} "
        f"are at most 4 times finer than needed, {coarse} off by more than 1 %; with findings at "
        f"the recommended step: {sum(bool(one.own.findings) for one in found)}"
    )


def _ladder_row(one: Ladder) -> str:
    times = f"{one.times_too_fine:g}" if one.is_settled else "-"
    findings = ", ".join(sorted(set(one.own.findings)))
    return f"{one.name:42}{one.recommended:10.3g}{one.own.error:9.1e}{times:>7}  {findings}"


def _hush() -> None:
    """Drop what the engine prints."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


TABLES: dict[str, Callable[[ProcessPoolExecutor], None]] = {
    "errors": _errors,
    "tolerance": _tolerance,
    "steps": _steps,
}

if __name__ == "__main__":
    main(sys.argv[1:])
