"""A torque over time: a piecewise cubic polynomial, held before its start and after its end."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Interpolation = Literal["step", "linear", "cubic"]


@dataclass(frozen=True, slots=True)
class Signal:
    """Values between `times` [s]; `pieces[i]` holds the coefficients of 1, s, s², s³ on piece i.

    s is the time since `times[i]`. The last piece begins at the last time and is constant. With a
    `period` the signal repeats from time zero.
    """

    times: tuple[float, ...]
    pieces: tuple[tuple[float, float, float, float], ...]
    period: float | None = None

    def at(self, time: float) -> float:
        """Return the value at a time [s]."""
        if self.period is not None:
            time %= self.period
        index = bisect_right(self.times, time) - 1
        if index < 0:
            return self.pieces[0][0]
        c0, c1, c2, c3 = self.pieces[index]
        s = time - self.times[index]
        return c0 + s * (c1 + s * (c2 + s * c3))

    def steady_until(self, time: float) -> float:
        """Return the time [s] up to which the value stays what it is at `time`.

        That is `time` itself where the value is changing, infinity where it never changes again.
        """
        if self.pieces.count((self.pieces[0][0], 0.0, 0.0, 0.0)) == len(self.pieces):
            return math.inf
        if self.period is not None:
            return time
        index = bisect_right(self.times, time) - 1
        if index < 0:
            return self.times[0]
        if self.pieces[index][1:] != (0.0, 0.0, 0.0):
            return time
        return self.times[index + 1] if index + 1 < len(self.times) else math.inf


def through(
    waypoints: Sequence[tuple[float, float]], interpolation: Interpolation, repeat: bool
) -> Signal:
    """Return the signal through (time, value) pairs whose times increase.

    With `repeat` the time of the last pair is the period, and the last value is met at its end.
    """
    times = tuple(time for time, _ in waypoints)
    values = [value for _, value in waypoints]
    period = times[-1] if repeat else None
    if interpolation == "cubic" and len(waypoints) > 1:
        pieces = _cubic(times, values, repeat)
    elif interpolation == "linear":
        pieces = [
            (values[i], (values[i + 1] - values[i]) / (times[i + 1] - times[i]), 0.0, 0.0)
            for i in range(len(values) - 1)
        ]
    else:
        pieces = [(value, 0.0, 0.0, 0.0) for value in values[:-1]]
    return Signal(times, (*pieces, (values[-1], 0.0, 0.0, 0.0)), period)


def _cubic(
    times: Sequence[float], values: Sequence[float], repeat: bool
) -> list[tuple[float, float, float, float]]:
    """Return the twice differentiable spline; level at its ends, where the held values join it."""
    # scipy takes half a second to import, and few scenes want splines
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(times, values, bc_type="periodic" if repeat else "clamped")
    cubes, squares, slopes, constants = spline.c.tolist()
    return list(zip(constants, slopes, squares, cubes, strict=True))
