"""Outcomes of one scene at several steps: whether runs draw together, or part ways.

A grasp that holds at one step and slips at another has no error that falls with the step: its runs
jump between outcomes. Then all outcomes are named, each with the steps that lead to it. Runs that
all lead to one outcome that a finer step would leave cannot be told from converged ones.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.column_families import QUATERNION_UNIT
from somo_cli.analysis.error_estimate import ColumnError
from somo_cli.analysis.observed_order import LEAST_ORDER
from somo_cli.analysis.verdict import quantity
from somo_cli.arrays import Array

APART = 0.25  # of the scale of a column: ends as far apart are not those of one outcome
STEEPEST_ORDER = 4  # a difference that falls faster from one step to the next fell at once

ROUNDING = 1e-6  # of the scale


@dataclass(frozen=True, slots=True)
class Outcome:
    """Where a column ends, in its unit, and the steps [s] that lead there, coarse to fine."""

    value: float
    steps: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Outcomes:
    """The outcomes of the column whose ends jump most over its scale, the finest step's last."""

    name: str
    unit: str
    outcomes: tuple[Outcome, ...]

    def parts_last_of_three(self, steps: Sequence[float]) -> bool:
        """Whether the last two of these steps agree, and the one before ended elsewhere.

        Then it is a single halving that speaks for this outcome.
        """
        final = self.outcomes[-1].steps
        return len(steps) > 2 and steps[-2] in final and steps[-3] not in final

    @property
    def sentence(self) -> str:
        """All outcomes, each with its steps."""
        ends = [
            f"at {quantity(one.value, self.unit)} at {_listed(one.steps)} s"
            for one in self.outcomes
        ]
        is_each_alone = len(ends) > 2 and all(len(one.steps) == 1 for one in self.outcomes)
        count = {2: "two outcomes"}.get(len(ends), f"{len(ends)} outcomes")
        start = "each step ends elsewhere" if is_each_alone else count
        return f"{start}: {self.name} ends {', '.join(ends[:-1])} and {ends[-1]}"

    def plain_data(self) -> dict[str, object]:
        """Return the same as values for JSON."""
        return {
            "column": self.name,
            "outcomes": [
                {"value": one.value, "time_steps_s": list(one.steps)} for one in self.outcomes
            ],
        }


def outcomes(errors: Sequence[ColumnError], steps: Sequence[float], ends: Array) -> Outcomes | None:
    """Return the outcomes of runs at these steps [s], coarse to fine, None if they draw together.

    `ends`, shape (steps, columns), are the last values of the columns that the errors are of, at
    one instant, unit quaternions with the same sign. What is judged by a mean or an impulse has
    jumps of its own and is left out.
    """
    found: list[tuple[tuple[bool, float], Outcomes]] = []
    for column, error in enumerate(errors):
        if error.measure != "largest" or error.scale <= 0:
            continue
        values = ends[:, column]
        if not _is_parted(values, steps, error.scale):
            continue
        groups = _grouped(values, steps, error.scale)
        if len(groups) > 1:
            # the components of a quaternion say least to a reader
            key = error.unit != QUATERNION_UNIT, float(np.ptp(values)) / error.scale
            found.append((key, Outcomes(error.name, error.unit, groups)))
    return max(found, key=lambda one: one[0])[1] if found else None


def _is_parted(values: Array, steps: Sequence[float], scale: float) -> bool:
    """Whether an end jumps from one step to the next, not as an error that falls with the step."""
    turns = np.diff(values)
    apart = np.abs(turns)
    if np.any((turns[:-1] * turns[1:] < 0) & (np.minimum(apart[:-1], apart[1:]) >= APART * scale)):
        return True
    for place, size in enumerate(apart.tolist()):
        if size < APART * scale:
            continue
        is_last = place == len(apart) - 1
        first = place - 1 if is_last else place
        if first < 0:
            return False  # two runs do not show how their difference falls
        coarse, fine = apart[first : first + 2].tolist()
        falls = coarse >= fine * _ratio(steps[first : first + 3], LEAST_ORDER)
        falls_at_once = coarse > fine * _ratio(steps[first : first + 3], STEEPEST_ORDER)
        if not falls or (falls_at_once and not is_last):
            return True
    return False


def _ratio(steps: Sequence[float], order: float) -> float:
    """Return the first over the second difference of three runs whose error has an order."""
    first, second, third = (math.pow(step, order) for step in steps)
    return (first - second) / (second - third)


def _grouped(values: Array, steps: Sequence[float], scale: float) -> tuple[Outcome, ...]:
    """Return the outcomes: ends with no gap of APART between them belong together."""
    order = np.argsort(values, kind="stable").tolist()
    groups: list[list[int]] = [[order[0]]]
    for before, place in itertools.pairwise(order):
        if values[place] - values[before] >= APART * scale:
            groups.append([])
        groups[-1].append(place)
    by_finest = sorted((sorted(group) for group in groups), key=lambda group: group[-1])
    return tuple(
        Outcome(_rounded(float(values[group[-1]]), scale), tuple(steps[place] for place in group))
        for group in by_finest
    )


def _rounded(value: float, scale: float) -> float:
    """Return zero for what is rounding beside the scale."""
    return 0.0 if abs(value) < ROUNDING * scale else value


def _listed(steps: Sequence[float]) -> str:
    texts = [f"{step:g}" for step in steps]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"
