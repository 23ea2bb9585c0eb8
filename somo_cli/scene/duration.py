"""Simulated time and time steps."""

from __future__ import annotations

import math

WHOLE = 1e-6  # of a step: as near to a whole number of steps a time is one, in floating point


def steps_of(duration: float, time_step: float) -> int:
    """Return the number of steps [-] of a time [s], the nearest whole one."""
    return round(duration / time_step)


def is_whole(duration: float, time_step: float) -> bool:
    """Return whether a time [s] is a whole number of steps."""
    steps = duration / time_step
    return math.isclose(steps, round(steps), rel_tol=1e-9, abs_tol=WHOLE)
