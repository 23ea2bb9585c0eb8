"""Values over time: piecewise cubic and constant beyond both ends, or a wave that never ends."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

from somo_cli.scene import cubic_spline

Interpolation = Literal["step", "linear", "cubic"]
WaveShape = Literal["sine", "triangle", "square", "trapezoid"]

TWO_PI = 2 * math.pi  # rad
NO_CHANGE = (0.0, 0.0, 0.0)  # coefficients of s, s² and s³ of a constant piece


class Signal(Protocol):
    """A value at every time."""

    def at(self, time: float) -> float:
        """Return the value at a time [s]."""

    def constant_until(self, time: float) -> float:
        """Return the time [s] until which the value stays as it is at `time`."""

    @property
    def constant_from(self) -> float:
        """The time [s] after which the value is constant; 0 if it never becomes constant."""


@dataclass(frozen=True, slots=True)
class PiecewiseSignal:
    """A piecewise cubic; `pieces[i]` holds the coefficients of 1, s, s², s³ from `times[i]` [s] on.

    s is the time since `times[i]` [s]. The last piece is constant. With a `period` [s] the signal
    repeats from time zero.
    """

    times: tuple[float, ...]
    pieces: tuple[tuple[float, float, float, float], ...]
    period: float | None = None
    is_constant: bool = field(init=False, repr=False, compare=False)
    """Whether the value is the same at all times; found once, since that takes every piece."""

    def __post_init__(self) -> None:
        same = (self.pieces[0][0], *NO_CHANGE)
        object.__setattr__(self, "is_constant", self.pieces.count(same) == len(self.pieces))

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

    @property
    def constant_from(self) -> float:
        """The time [s] after which the value is constant; 0 if the signal repeats."""
        return 0.0 if self.period is not None else self.times[-1]

    def constant_until(self, time: float) -> float:
        """Return the time [s] until which the value stays as it is at `time`.

        It is `time` itself if the value is changing, infinity if it never changes again.
        """
        index = bisect_right(self.times, time) - 1
        if self.period is None and index >= 0 and self.pieces[index][1:] != NO_CHANGE:
            return time
        if self.is_constant:
            return math.inf
        if self.period is not None:
            return time
        if index < 0:
            return self.times[0]
        return self.times[index + 1] if index + 1 < len(self.times) else math.inf


@dataclass(frozen=True, slots=True)
class Wave:
    """The wave offset + amplitude * shape(2 π frequency t + phase), which never ends.

    `frequency` is in Hz and `phase` in rad. Like a sine, each shape starts at zero and rises to 1;
    a square is 1 in its first half period. A trapezoid rises from -1 to 1 in the part `rise` of its
    period, at most 0.5, and falls in the same time; with 0.5 it is a triangle.
    """

    shape: WaveShape
    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0
    rise: float = 0.25

    def at(self, time: float) -> float:
        """Return the value at a time [s]."""
        turns = (self.frequency * time + self.phase / TWO_PI) % 1.0
        if self.shape == "sine":  # the most frequent shape, without another function call
            return self.offset + self.amplitude * math.sin(TWO_PI * turns)
        return self.offset + self.amplitude * self._unit_shape(turns)

    def constant_until(self, time: float) -> float:
        """Return the time [s] until which the value stays as it is at `time`."""
        if self.amplitude == 0 or self.frequency == 0:
            return math.inf
        if self.shape != "square":
            return time
        half_turns = 2 * (self.frequency * time + self.phase / TWO_PI)
        # a little too early, so that the next call is never made too late
        until = time + (math.floor(half_turns) + 1 - half_turns) / (2 * self.frequency)
        return until - 1e-12 * abs(until)

    @property
    def constant_from(self) -> float:
        """0: a wave never becomes constant."""
        return 0.0

    def _unit_shape(self, turns: float) -> float:
        if self.shape == "square":
            return 1.0 if turns < 0.5 else -1.0
        triangle = 4 * turns if turns < 0.25 else 2 - 4 * turns if turns < 0.75 else 4 * turns - 4
        if self.shape == "triangle":
            return triangle
        return max(-1.0, min(1.0, triangle / (2 * self.rise)))


def piecewise_signal(
    waypoints: Sequence[tuple[float, float]], interpolation: Interpolation, repeat: bool
) -> PiecewiseSignal:
    """Return the signal through (time [s], value) pairs in order of time.

    With `repeat` the time of the last pair is the period.
    """
    times = tuple(time for time, _ in waypoints)
    values = [value for _, value in waypoints]
    period = times[-1] if repeat else None
    if values.count(values[0]) == len(values):  # quicker for many, and the same to the last bit
        pieces = [(values[0], 0.0, 0.0, 0.0)] * (len(values) - 1)
    elif interpolation == "cubic" and len(waypoints) > 1:
        pieces = _cubic_pieces(times, values, repeat)
    elif interpolation == "linear":
        pieces = [
            (values[i], _slope(values[i + 1] - values[i], times[i + 1] - times[i]), 0.0, 0.0)
            for i in range(len(values) - 1)
        ]
    else:
        pieces = [(value, 0.0, 0.0, 0.0) for value in values[:-1]]
    return PiecewiseSignal(times, (*pieces, (values[-1], 0.0, 0.0, 0.0)), period)


def _cubic_pieces(
    times: Sequence[float], values: Sequence[float], repeat: bool
) -> list[tuple[float, float, float, float]]:
    """Return the pieces of the cubic spline; without `repeat` its slope is zero at both ends."""
    slopes = (cubic_spline.periodic_slopes if repeat else cubic_spline.clamped_slopes)(
        times, values
    )
    pieces = []
    for i, (value, slope) in enumerate(zip(values[:-1], slopes[:-1], strict=True)):
        width = times[i + 1] - times[i]
        chord = (values[i + 1] - value) / width
        bend = (slope + slopes[i + 1] - 2 * chord) / width
        pieces.append((value, slope, (chord - slope) / width - bend, bend / width))
    return pieces


def _slope(rise: float, width: float) -> float:
    """Return the slope of a straight piece, or 0 if the slope is too large for a float.

    With an infinite slope the value at the start of the piece would be 0 times infinity.
    """
    slope = rise / width
    return slope if math.isfinite(slope) else 0.0
