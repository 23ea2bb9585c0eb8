"""When pictures are taken: the times of a film, and how fast it shows them."""

from __future__ import annotations

from fractions import Fraction

DEFAULT_FRAME_RATE = 25
"""Pictures per second of a film that is not told otherwise."""


def times_of(first: float, last: float, every: float) -> tuple[float, ...]:
    """Return first, first + every, ... [s], up to the last time; rounding drops none."""
    count = int((last - first) / every * (1 + 1e-9) + 1e-9) + 1
    return tuple(min(first + number * every, last) for number in range(count))


def rate_of(every: float, speed: float) -> Fraction:
    """Return pictures per second for pictures `every` [s] apart, shown `speed` times as fast."""
    return Fraction(speed / every).limit_denominator(1000)
