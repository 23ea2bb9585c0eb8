"""Differences between runs of one scene at different steps, column by column, row by row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.column_families import ColumnFamily, column_families, force_columns
from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.simulation.plan.model import Plan

ROWS_AT_ONCE = 256  # even, so that every second row stays every second one


@dataclass(frozen=True, slots=True)
class LevelRows:
    """The rows of a run, in turn: `read` gives the next so many of them, with impulses.

    A run at twice the step may have every second row only, with a `stride` of 2.
    """

    read: Callable[[int], Array]
    stride: int = 1


@dataclass(frozen=True, slots=True)
class Differences:
    """How far a run is from a finer one, arrays of shape (columns,), without the time.

    `final`, `largest` and `rms` are of the values at the rows. `judged` is by the measure of the
    family of the column, in its unit; `range` is how far the column moved in both runs, by the same
    measure.
    """

    final: Array
    largest: Array
    rms: Array
    judged: Array
    range: Array


class DifferenceAccumulator:
    """Adds up the differences of two runs from blocks of their rows, those of RowsWithImpulses."""

    def __init__(self, plan: Plan) -> None:
        recorded = plan.recorded
        self.families = column_families(recorded)
        self._aligned = QuaternionAlignment(plan)
        self._judged = judged_columns(plan)
        width = len(self._judged)
        self._width = width
        self._first: Array | None = None
        self._final: Array = np.zeros(width)
        self._largest: Array = np.zeros(width)
        self._squares: Array = np.zeros(width)
        self._judged_final: Array = np.zeros(width)
        self._judged_sum: Array = np.zeros(width)
        self._least: Array = np.full(width, np.inf)
        self._most: Array = np.full(width, -np.inf)
        self._time = 0.0
        self._count = 0

    def add(self, rows: Array, finer: Array) -> None:
        """Add rows of both runs at the same instants, shape (rows, columns with impulses)."""
        if self._first is None:
            self._first = finer[:1]
        finer = self._aligned(finer, np.broadcast_to(self._first, finer.shape))
        rows = self._aligned(rows, finer)
        difference = np.abs(rows - finer)
        values = difference[:, 1 : self._width + 1]
        self._final = values[-1]
        self._largest = np.maximum(self._largest, values.max(axis=0))
        self._squares += np.sum(values**2, axis=0)
        judged = difference[:, self._judged]
        self._judged_final = judged[-1]
        self._judged_sum += judged.sum(axis=0)
        for one in (rows[:, self._judged], finer[:, self._judged]):
            self._least = np.minimum(self._least, one.min(axis=0))
            self._most = np.maximum(self._most, one.max(axis=0))
        self._time = float(finer[-1, 0])
        self._count += len(rows)

    def differences(self) -> Differences:
        """Return the differences of all rows that were added, one at least."""
        mean = self._judged_sum / self._count
        judged, span = self._largest.copy(), self._most - self._least
        for family in self.families:
            part = np.array(family.columns) - 1
            if family.measure == "mean":
                judged[part] = mean[part]
            if family.measure == "impulse":
                duration = self._time or 1.0
                judged[part] = np.maximum(mean[part], self._judged_final[part]) / duration
                span[part] /= duration
        rms = np.sqrt(self._squares / self._count)
        return Differences(self._final, self._largest, rms, judged, span)


class OrderAccumulator:
    """Adds up what tells the order of each family from three runs, each with half the step."""

    def __init__(self, plan: Plan) -> None:
        self._families = column_families(plan.recorded)
        self._aligned = QuaternionAlignment(plan)
        self._judged = judged_columns(plan)
        self._products: Array = np.zeros((3, len(self._judged)))
        self.ends: Array = np.empty((0, len(self._judged)))
        """The values of the three runs at their last common instant, shape (3, columns)."""

    def add(self, first: Array, second: Array, third: Array) -> None:
        """Add rows of the three runs at the same instants, the coarsest first."""
        if not len(third):
            return
        first, second = self._aligned(first, third), self._aligned(second, third)
        width = len(self._judged) + 1
        self.ends = np.array([one[-1, 1:width] for one in (first, second, third)])
        before = (first - second)[:, self._judged]
        after = (second - third)[:, self._judged]
        self._products += [
            (one * other).sum(axis=0)
            for one, other in ((before, before), (before, after), (after, after))
        ]

    def products(self, family: ColumnFamily) -> tuple[float, float, float]:
        """Return before², before · after and after², over all rows and columns of a family.

        `before` and `after` are the differences of the coarser and of the finer two runs.
        """
        part = np.array(family.columns) - 1
        before, both, after = self._products[:, part].sum(axis=1).tolist()
        return before, both, after


def compare(
    plan: Plan, levels: Sequence[LevelRows], pair: tuple[int, int]
) -> tuple[Differences | None, OrderAccumulator | None]:
    """Return the differences of two of the levels, coarse to fine, and the order of three.

    There are two or three levels. Rows that not all levels have are left out: a run may have
    stopped earlier than another. No differences are returned if only the start is common.
    """
    differences, order = DifferenceAccumulator(plan), OrderAccumulator(plan)
    count = 0
    while True:
        blocks = [one.read(ROWS_AT_ONCE // one.stride) for one in levels]
        first, second = common_rows([blocks[at] for at in pair])
        if not len(first):
            break
        count += len(first)
        differences.add(first, second)
        if len(levels) == 3:
            order.add(*common_rows(_at_stride(levels, blocks)))
    found = differences.differences() if count > 1 else None
    return found, order if len(levels) == 3 else None


def _at_stride(levels: Sequence[LevelRows], blocks: Sequence[Array]) -> list[Array]:
    """Return of each block the rows that the level with the fewest rows has as well."""
    stride = max(one.stride for one in levels)
    return [block[:: stride // one.stride] for one, block in zip(levels, blocks, strict=True)]


def common_rows(blocks: Sequence[Array]) -> list[Array]:
    """Return the rows of all blocks that are of the same instant at the same place."""
    count = min(map(len, blocks))
    is_same = np.ones(count, dtype=bool)
    for one in blocks:
        is_same &= one[:count, 0] == blocks[0][:count, 0]
    return [one[:count][is_same] for one in blocks]


class QuaternionAlignment:
    """Gives unit quaternions the sign nearer to that of others: q and -q are one rotation."""

    def __init__(self, plan: Plan) -> None:
        self._quaternions = [list(one) for one in columns.quaternion_columns(plan.recorded)]

    def __call__(self, rows: Array, others: Array) -> Array:
        """Return rows with the signs of the others, both of shape (rows, columns)."""
        if not self._quaternions:
            return rows
        rows = rows.copy()
        for part in self._quaternions:
            is_opposite = np.sum(rows[:, part] * others[:, part], axis=1) < 0
            rows[np.ix_(is_opposite, part)] *= -1
        return rows


def judged_columns(plan: Plan) -> list[int]:
    """Return what each column but the time is judged by: itself, or the impulse behind all."""
    recorded = plan.recorded
    width = len(columns.header(recorded))
    found = list(range(1, width))
    for place, column in enumerate(force_columns(recorded)):
        found[column - 1] = width + place
    return found
