"""All that is known of one case, and its line of the matrix."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from somo_cli.analysis.numerics import assess
from tests.extreme.case import Case
from tests.extreme.edge import MARGIN, Edge, edge
from tests.extreme.trial import SHOWN_GAIN, TOO_FAST, Outcome, outcome

SMALLEST = 1e-9  # figures below it are rounding, which differs from machine to machine
HEADER = ("case", "implicit", "euler", "explicit", "limit", "said beforehand")


@dataclass(frozen=True, slots=True)
class Verdict:
    """One case: what came of every integrator, the explicit limit, what `check --numerics` says.

    `said` holds the codes of errors and warnings about the implicit run.
    """

    case: Case
    implicit: Outcome
    euler: Outcome
    explicit: Outcome
    edge: Edge | None
    said: tuple[str, ...]

    @property
    def is_hole(self) -> bool:
        """Whether a damped case fails under an integrator that is made for it."""
        runs = (self.implicit, self.euler)
        return self.case.is_damped and any(_fails(one) for one in runs)

    @property
    def is_surprise(self) -> bool:
        """Whether it cannot be simulated, for whatever reason, and nothing says so beforehand."""
        runs = (self.implicit, self.euler)
        return not self.said and not all(one.is_stable for one in runs)

    @property
    def is_too_fast(self) -> bool:
        """Whether implicit or euler met a motion that no step of this length follows."""
        return self.implicit.is_too_fast or self.euler.is_too_fast

    @property
    def agrees(self) -> bool:
        """Whether the explicit law holds at the case's own step just where it should."""
        return self.edge is not None and self.explicit.is_stable == (
            self.case.time_step <= self.edge.limit
        )

    @property
    def cells(self) -> tuple[str, ...]:
        """The cells of the matrix under HEADER."""
        runs = (self.implicit, self.euler, self.explicit)
        said = " ".join(self.said)
        return (self.case.name, *(_outcome_words(one) for one in runs), _limit(self), said)


def verdict(case: Case) -> Verdict:
    """Run a case with every integrator and on both sides of the explicit limit."""
    plan = case.plan("implicit", case.time_step, 1)
    found = assess(plan, case.document, {}).findings
    codes = {one.code or "document" for one in found if one.severity in ("error", "warning")}
    return Verdict(
        case,
        outcome(case, "implicit"),
        outcome(case, "euler"),
        outcome(case, "explicit"),
        edge(case),
        tuple(sorted(codes)),
    )


def matrix(verdicts: Sequence[Verdict]) -> str:
    """Return the table of all cases."""
    rows = [HEADER, *(one.cells for one in verdicts)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADER))]
    lines = (
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )
    return "".join(f"{line}\n" for line in lines)


def summary(verdicts: Sequence[Verdict]) -> str:
    """Return the counts that matter, one a line."""
    edges = [one.edge for one in verdicts if one.edge is not None]
    damped = [one for one in verdicts if one.case.is_damped]
    lines = [
        f"{len(verdicts)} cases, {len(damped)} of them damped",
        "damped cases in which implicit or euler fail: "
        + _listed(one for one in verdicts if one.is_hole),
        f"cases that turn a joint by more than {TOO_FAST:g} rad in a step: "
        + _listed(one for one in verdicts if one.is_too_fast),
        "cases that cannot be simulated, which `somo check --numerics` does not say: "
        + _listed(one for one in verdicts if one.is_surprise),
        f"explicit is as predicted at its own step in "
        f"{sum(one.agrees for one in verdicts)} of {len(edges)}",
        f"explicit holds at the predicted limit / {MARGIN} in "
        f"{sum(one.optimism == MARGIN for one in edges)} of {len(edges)}; "
        f"worst optimism: a factor of {max(one.optimism for one in edges):g}",
        "cases that fail below it: "
        + _listed(one for one in verdicts if one.edge is not None and one.edge.optimism > MARGIN),
        f"explicit fails at the predicted limit x {MARGIN} in "
        f"{sum(one.pessimism == MARGIN for one in edges)} of {len(edges)}; "
        f"worst pessimism: a factor of {max(one.pessimism for one in edges):g}",
    ]
    return "".join(f"{line}\n" for line in lines)


def _listed(verdicts: Iterable[Verdict]) -> str:
    names = [one.case.name for one in verdicts]
    return f"{len(names)}" + "".join(f"\n  {name}" for name in names)


def _fails(run: Outcome) -> bool:
    if run.is_too_fast:
        return False
    return run.diverged is not None or run.is_restless or run.is_creative


def _outcome_words(run: Outcome) -> str:
    """Return in words how a run ended, as the table of `make extreme` prints it."""
    if run.refused is not None:
        return "refused"
    if run.diverged is not None:
        return "too fast" if run.is_too_fast else "diverges"
    words = ["too fast"] if run.is_too_fast else []
    if run.is_restless:
        words.append(f"restless {_decade(run.apart or 0.0)}")
    elif run.is_due:
        words.append(f"rests {_decade(run.apart or 0.0)}")
    if run.gain is not None and not run.gain < SHOWN_GAIN:
        words.append(f"gains {_decade(run.gain)}")
    if run.lost is not None:
        words.append(f"loses {_decade(run.lost)}")
    return ", ".join(words) or "holds"


def _decade(value: float) -> str:
    """Return the power of ten below which a figure is."""
    if not value >= SMALLEST:
        return f"<{SMALLEST:.0e}"
    return f"<1e{math.floor(math.log10(value)) + 1:d}"


def _limit(one: Verdict) -> str:
    if one.edge is None:
        return "none"
    words = [f"{one.edge.limit:.2g}"]
    if one.edge.optimism > MARGIN:
        words.append(f"optimistic x{one.edge.optimism:g}")
    if one.edge.pessimism > MARGIN:
        words.append(f"pessimistic x{one.edge.pessimism:g}")
    return " ".join(words)
