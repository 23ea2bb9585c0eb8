"""The times of the pictures of a film, and its frame rate."""

from __future__ import annotations

from fractions import Fraction

DEFAULT_FRAME_RATE = 25
"""Pictures per second of a film, unless an interval is given."""


def times_of(first: float, last: float, every: float) -> tuple[float, ...]:
    """Return first, first + every, ... up to the last time [s]; rounding drops none."""
    count = int((last - first) / every * (1 + 1e-9) + 1e-9) + 1
    return tuple(min(first + number * every, last) for number in range(count))


def rate_of(every: float, speed: float) -> Fraction:
    """Return the frame rate [1/s] of pictures `every` [s] apart, shown `speed` times as fast."""
    return Fraction(speed / every).limit_denominator(1000)
