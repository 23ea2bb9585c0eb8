"""One number from a column over time: what a label takes.

Between two rows a column is a straight line.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """A column over time [s], shape (rows,) each."""

    time: Array
    values: Array

    def __bool__(self) -> bool:
        """Refuse to be a condition: a column is neither true nor false."""
        raise ValueError("a column is neither true nor false: take its max or last")

    def between(self, after: float | None, before: float | None) -> Series:
        """Return the rows from `after` to `before` [s], both included; all where they are None."""
        kept = np.ones(len(self.time), dtype=bool)
        if after is not None:
            kept &= self.time >= after - 1e-9
        if before is not None:
            kept &= self.time <= before + 1e-9
        return Series(self.time[kept], self.values[kept])


@dataclass(frozen=True, slots=True)
class Options:
    """What some reductions need: a level, a tolerance and a time or period [s]."""

    level: float = 0.0
    within: float = 0.0
    at: float = 0.0
    period: float = 1.0


Reduction = Callable[[Series, Options], float]


def _integral(one: Series, _: Options) -> float:
    return float(np.sum(np.diff(one.time) * (one.values[1:] + one.values[:-1]) / 2))


def _mean(one: Series, options: Options) -> float:
    duration = float(one.time[-1] - one.time[0])
    return _integral(one, options) / duration if duration else float(one.values[-1])


def _share_above(values: Array) -> Array:
    """Return the share of each interval in which a straight line between two values is above 0."""
    first, last = values[:-1], values[1:]
    size = np.abs(first) + np.abs(last)
    above = np.maximum(first, 0) + np.maximum(last, 0)
    return np.where(size > 0, above / np.where(size > 0, size, 1), 0.0)


def _time_above(one: Series, options: Options) -> float:
    return float(np.sum(np.diff(one.time) * _share_above(one.values - options.level)))


def _time_below(one: Series, options: Options) -> float:
    return float(np.sum(np.diff(one.time) * _share_above(options.level - one.values)))


def _first_above(one: Series, options: Options) -> float:
    over = one.values - options.level
    (found,) = np.nonzero(over > 0)
    if not len(found):
        return math.nan
    row = int(found[0])
    if row == 0:
        return float(one.time[0])
    share = -over[row - 1] / (over[row] - over[row - 1])
    return float(one.time[row - 1] + share * (one.time[row] - one.time[row - 1]))


def _first_below(one: Series, options: Options) -> float:
    return _first_above(Series(one.time, -one.values), Options(level=-options.level))


def _settle_time(one: Series, options: Options) -> float:
    """Return the time from which on the column stays within a tolerance of its last value."""
    (far,) = np.nonzero(np.abs(one.values - one.values[-1]) > options.within)
    return float(one.time[0] if not len(far) else one.time[far[-1] + 1])


def _crossings(one: Series, options: Options) -> float:
    is_above = one.values > options.level
    return float(np.count_nonzero(is_above[1:] & ~is_above[:-1]))


def _at(one: Series, options: Options) -> float:
    return float(np.interp(options.at, one.time, one.values))


def _per_cycle(one: Series, options: Options) -> float:
    """Return the change in a cycle, the mean over all whole ones."""
    start = float(one.time[0])
    count = math.floor((one.time[-1] - start) / options.period + 1e-9)
    if count < 1:
        return math.nan
    end = np.interp(start + count * options.period, one.time, one.values)
    return float((end - one.values[0]) / count)


REDUCTIONS: dict[str, Reduction] = {
    "first": lambda one, _: float(one.values[0]),
    "last": lambda one, _: float(one.values[-1]),
    "min": lambda one, _: float(one.values.min()),
    "max": lambda one, _: float(one.values.max()),
    "mean": _mean,
    "std": lambda one, _: float(one.values.std()),
    "median": lambda one, _: float(np.median(one.values)),
    "range": lambda one, _: float(one.values.max() - one.values.min()),
    "integral": _integral,
    "at": _at,
    "time_above": _time_above,
    "time_below": _time_below,
    "first_above": _first_above,
    "first_below": _first_below,
    "settle_time": _settle_time,
    "crossings": _crossings,
    "per_cycle": _per_cycle,
}
"""What a label can take, by name."""

NEEDS = {
    "at": "at",
    "time_above": "level",
    "time_below": "level",
    "first_above": "level",
    "first_below": "level",
    "settle_time": "within",
    "crossings": "level",
    "per_cycle": "period",
}
"""The option that a reduction needs."""


def reduced(one: Series, name: str, options: Options | None = None) -> float:
    """Return the number that a reduction takes from a column; NaN from one without rows."""
    if not len(one.time):
        return math.nan
    return REDUCTIONS[name](one, options or Options())
