"""Instants at which runs with different time steps can be compared."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

TARGET_COUNT = 50  # in a run: enough for a maximum over time, few enough to cost little
MINIMUM_COUNT = 10
MAX_DENOMINATOR = 10**7  # the largest denominator of a simple fraction


class NoCommonInstants(ValueError):
    """The time steps have too few instants in common."""


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
        """Return the number of steps of `time_step` [s] between two instants."""
        steps = self.interval / exact_fraction(time_step)
        assert steps.denominator == 1, "the instants are multiples of this step"
        return int(steps)


def exact_fraction(time_step: float) -> Fraction:
    """Return a time step [s] as the simplest fraction with the same float, such as 1/240."""
    simple = Fraction(time_step).limit_denominator(MAX_DENOMINATOR)
    return simple if float(simple) == time_step else Fraction(repr(time_step))


def common_instants(time_steps: Sequence[float], duration: float) -> Instants:
    """Return the instants up to `duration` [s] that are multiples of all these steps [s].

    Raises NoCommonInstants.
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


def scaled_steps(time_step: float, factors: Sequence[Fraction]) -> tuple[float, ...]:
    """Return the time step times each factor [s], as exact decimals where possible."""
    return tuple(float(exact_fraction(time_step) * factor) for factor in factors)
