"""Rows with the impulses of contact forces behind them, however far apart rows are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from somo_cli.analysis.column_families import force_columns
from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.simulation.plan.model import Plan


def width_with_impulses(plan: Plan) -> int:
    """Return the number of columns of `RowsWithImpulses`: those of the plan, and the impulses."""
    return len(columns.header(plan.recorded)) + len(force_columns(plan.recorded))


def sampled_plan(plan: Plan) -> Plan:
    """Return the plan to run for `RowsWithImpulses`.

    An impact may press in a single step, so a plan that records contact forces records every one.
    The states of a run do not depend on which of them are recorded.
    """
    return replace(plan, every=1) if force_columns(plan.recorded) else plan


class RowsWithImpulses:
    """Takes the rows of `sampled_plan(plan)`, and passes on the rows of the plan.

    Behind the columns are the impulses of the contact forces since the start [N·s], one for each
    column of a force. A row has the forces of the step before it.
    """

    def __init__(self, plan: Plan, write: Callable[[Array], None]) -> None:
        self._forces = list(force_columns(plan.recorded))
        self._every = plan.every if self._forces else 1
        self._time_step = plan.time_step
        self._records_last = plan.records_last_step
        self._write = write
        self._taken = 0
        self._total: Array = np.zeros(len(self._forces))
        self._left: Array | None = None
        self.written = 0
        self.last: Array | None = None
        """The last row that was passed on, with impulses, shape (1, columns)."""

    def take(self, rows: Array) -> None:
        """Take rows, shape (rows, columns), and pass on those that the plan records."""
        impulses = self._total + np.cumsum(rows[:, self._forces] * self._time_step, axis=0)
        extended = np.hstack([rows, impulses])
        self._total = impulses[-1]
        is_recorded = np.arange(self._taken, self._taken + len(rows)) % self._every == 0
        self._taken += len(rows)
        self._left = None if is_recorded[-1] else extended[-1:]
        self._pass_on(extended[is_recorded])

    def finish(self) -> None:
        """Pass on the last row as well where the plan records the last step."""
        if self._left is not None and self._records_last:
            self._pass_on(self._left)
        self._left = None

    def _pass_on(self, rows: Array) -> None:
        if len(rows):
            self.written += len(rows)
            self.last = rows[-1:].copy()
            self._write(rows)


def without_impulses(plan: Plan, write: Callable[[Array], None]) -> Callable[[Array], None]:
    """Return a function that passes rows on without the impulses behind their columns."""
    width = len(columns.header(plan.recorded))
    return lambda rows: write(np.ascontiguousarray(rows[:, :width]))
