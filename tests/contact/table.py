"""The tables of the bench."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tests.contact.candidates import Candidate
from tests.contact.cases import Case
from tests.contact.trial import Trial, Truth, trial, truth

STEPS = (4e-3, 2e-3, 1e-3, 5e-4)  # s
WRONG = 0.1  # relative error beyond which a run is not counted as stable


@dataclass(frozen=True, slots=True)
class Line:
    """One candidate in one case: a run for every step of the ladder."""

    candidate: Candidate
    case: Case
    truth: Truth
    trials: Sequence[Trial]

    def error(self, index: int) -> float:
        """Return the relative error at a step of the ladder."""
        return abs(self.trials[index].figure / self.truth.figure - 1)

    @property
    def largest_step(self) -> float:
        """The largest step [s] from which on down every run is right to `WRONG`; 0 for none."""
        largest = 0.0
        for index in reversed(range(len(self.trials))):
            if not self.error(index) <= WRONG:
                break
            largest = STEPS[index]
        return largest


def measured(candidate: Candidate, case: Case, steps: Sequence[float] = STEPS) -> Line:
    """Run a candidate through the ladder."""
    return Line(candidate, case, truth(case.name), [trial(case, step, candidate) for step in steps])


def header() -> str:
    """Return the head of the table of lines."""
    steps = "".join(f"{1e3 * step:>8g} ms" for step in STEPS)
    return f"{'':22}{'largest':>8}{steps}{'cost':>7}"


def text(line: Line, plain: Line) -> str:
    """Return a line of the table; the cost is that of a step over the plain law's, at 1 ms."""
    errors = "".join(f"{_error(line.error(index)):>11}" for index in range(len(STEPS)))
    at = STEPS.index(1e-3)
    cost = line.trials[at].seconds_per_step / plain.trials[at].seconds_per_step
    largest = f"{1e3 * line.largest_step:g} ms" if line.largest_step else "-"
    return f"  {line.candidate.name:20}{largest:>8}{errors}{_ratio(cost):>7}"


def worst(lines: Sequence[Line]) -> Iterator[str]:
    """Yield, for each candidate, its worst over all cases."""
    names = list(dict.fromkeys(line.candidate.name for line in lines))
    for name in names:
        own = [line for line in lines if line.candidate.name == name]
        largest = min(line.largest_step for line in own)
        errors = ""
        for index in range(len(STEPS)):
            # an error below what is known of the truth is none
            beyond = [_beyond(line, index) for line in own]
            errors += f"{_error(max(beyond, key=lambda one: math.inf if one != one else one)):>11}"
        reported = f"{1e3 * largest:g} ms" if largest else "-"
        yield f"  {name:20}{reported:>8}{errors}"


def _beyond(line: Line, index: int) -> float:
    known = line.truth.spread / abs(line.truth.figure)
    error = line.error(index)
    return error if math.isnan(error) else max(error, known)


def _error(value: float) -> str:
    return "fails" if math.isnan(value) else f"{value:.1e}"


def _ratio(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.2f}"
