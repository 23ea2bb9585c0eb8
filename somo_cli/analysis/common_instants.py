"""Instants that runs with different time steps have in common."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

TARGET_COUNT = 50  # instants in a run: enough for a maximum over time, few enough to cost nothing
MINIMUM_COUNT = 10
MAX_DENOMINATOR = 10**7  # the largest denominator of a simple fraction


class NoCommonInstants(ValueError):
    """The time steps do not meet often enough."""


@dataclass(frozen=True, slots=True)
class Instants:
    """`count` instants after the start, `interval` [s] apart."""

    interval: Fraction
    count: int

    @property
    def duration(self) -> float:
        """Time of the last instant [s]."""
        return float(self.interval * self.count)

    def steps_between(self, time_step: float) -> int:
        """Return the steps between two instants."""
        steps = self.interval / exact_fraction(time_step)
        assert steps.denominator == 1, "the step is one of those the instants were made for"
        return int(steps)


def exact_fraction(time_step: float) -> Fraction:
    """Return a time step as the simplest fraction that it can mean: 1/1000, or 1/240."""
    simple = Fraction(time_step).limit_denominator(MAX_DENOMINATOR)
    return simple if float(simple) == time_step else Fraction(repr(time_step))


def common_instants(time_steps: Sequence[float], duration: float) -> Instants:
    """Return the instants for runs of `duration` [s] with these steps [s].

    They end at the last one that is not after `duration`. Raises NoCommonInstants.
    """
    steps = [exact_fraction(step) for step in time_steps]
    denominator = math.lcm(*(step.denominator for step in steps))
    shared = Fraction(math.lcm(*(int(step * denominator) for step in steps)), denominator)
    wanted = exact_fraction(duration) / TARGET_COUNT
    interval = shared * max(1, int(wanted / shared))
    count = int(exact_fraction(duration) / interval)
    if count < MINIMUM_COUNT:
        raise NoCommonInstants(
            f"the time steps meet only every {float(shared):g} s, {count} times in {duration:g} s"
        )
    return Instants(interval, count)


def scaled_steps(time_step: float, rungs: Sequence[Fraction]) -> tuple[float, ...]:
    """Return the time step times each rung [s], as decimals that are exact where they can be."""
    return tuple(float(exact_fraction(time_step) * rung) for rung in rungs)
