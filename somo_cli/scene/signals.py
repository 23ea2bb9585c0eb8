"""A value over time: piecewise cubic and held at both ends, or a wave that never ends."""

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
NO_CHANGE = (0.0, 0.0, 0.0)  # coefficients of 1, s, s², s³ but the first, where nothing changes


class Signal(Protocol):
    """Anything with a value at every time."""

    def at(self, time: float) -> float:
        """Return the value at a time [s]."""

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the value stays what it is at `time`."""

    @property
    def constant_from(self) -> float:
        """The time [s] from which on the value is held; 0 if it goes on for ever."""


@dataclass(frozen=True, slots=True)
class PiecewiseSignal:
    """Values between `times` [s]; `pieces[i]` holds the coefficients of 1, s, s², s³ on piece i.

    s is the time since `times[i]`. The last piece begins at the last time and is constant. With a
    `period` the signal repeats from time zero.
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
        """The time [s] from which on the value is held; 0 if it goes on for ever."""
        return 0.0 if self.period is not None else self.times[-1]

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the value stays what it is at `time`.

        That is `time` itself where the value is changing, infinity where it never changes again.
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
    """offset + amplitude * shape(2 π frequency t + phase), from the start on and for ever.

    The shapes start at zero and rise, like a sine, to 1; a square is 1 in its first half. A
    trapezoid takes `rise`, at most half a period, from -1 to 1 and as much back; with a half it is
    a triangle. Frequency in Hz, phase in rad.
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
        if self.shape == "sine":  # most are, and a call costs as much as the rest
            return self.offset + self.amplitude * math.sin(TWO_PI * turns)
        return self.offset + self.amplitude * self._unit_shape(turns)

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the value stays what it is at `time`."""
        if self.amplitude == 0 or self.frequency == 0:
            return math.inf
        if self.shape != "square":
            return time
        half_turns = 2 * (self.frequency * time + self.phase / TWO_PI)
        # a little early rather than late: the next time of asking is then on the other side
        until = time + (math.floor(half_turns) + 1 - half_turns) / (2 * self.frequency)
        return until - 1e-12 * abs(until)

    @property
    def constant_from(self) -> float:
        """The time [s] from which on the value is held: 0, since it goes on for ever."""
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
    """Return the signal through (time, value) pairs whose times increase.

    With `repeat` the time of the last pair is the period, and the last value is met at its end.
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
    """Return the twice differentiable spline; level at its ends, where the held values join it."""
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
    """Return the slope of a straight piece; 0 where it rises too fast for a float, as a jump does.

    An infinite slope would make the value at the start of the piece 0 times infinity.
    """
    slope = rise / width
    return slope if math.isfinite(slope) else 0.0
