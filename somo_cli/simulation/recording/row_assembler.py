"""From bodies in motion to rows of the CSV: reads what the columns need, and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.simulation.engine.contacts import ContactPoint
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.monitoring.divergence import DivergenceMonitor
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of
from somo_cli.simulation.recording.row_buffers import BodyRowBuffer, ObjectRowBuffer

NUMBERS_PER_BATCH = 16384  # numbers kept until their columns are computed, the fastest batch
MAX_ROWS_PER_BATCH = 256  # rows kept, however narrow they are

RowWriter: TypeAlias = Callable[[Array], None]
"""Takes several rows at once, shape (rows, columns), in SI."""


class RowAssembler:
    """Makes the rows of a plan: `take` keeps the state of a step, `flush` writes the rows.

    The implicit integrator has velocities at half steps, and a row has the mean of two:
    `needs_next_step` says whether a column needs that, and `complete` adds the second. Columns are
    computed for many rows at once, after the divergence monitor has checked them.
    """

    def __init__(
        self,
        plan: Plan,
        world: World,
        body_steppers: Sequence[BodyStepper],
        divergence_monitor: DivergenceMonitor,
        write: RowWriter,
    ) -> None:
        self._world = world
        self._divergence_monitor = divergence_monitor
        self._write = write
        units = unit_factors_of(plan)
        groups, of_objects = (
            columns.body_column_groups(plan.recorded),
            columns.object_column_groups(plan.recorded),
        )
        self._first_of_objects = max((group.last for group in groups), default=1)
        self._width = len(columns.header(plan.recorded))
        self._capacity = max(1, min(MAX_ROWS_PER_BATCH, NUMBERS_PER_BATCH // self._width))
        buffer_size = (
            self._capacity + MONITORING_INTERVAL
        )  # rows are written when motion is checked
        self._bodies = [
            BodyRowBuffer(
                plan,
                number,
                body_stepper,
                [one for one in groups if one.body == number],
                units,
                buffer_size,
            )
            for number, body_stepper in enumerate(body_steppers)
        ]
        self._objects = [
            ObjectRowBuffer(plan, index, rigid_object, of_one, units)
            for index, rigid_object in enumerate(world.objects)
            if (of_one := [one for one in of_objects if one.object_index == index])
        ]
        self._parts: list[BodyRowBuffer | ObjectRowBuffer] = [*self._bodies, *self._objects]
        self._parts_with_velocities = [part for part in self._parts if part.needs_velocities]
        needs = columns.needs_of([*groups, *of_objects])
        keeps_all = plan.keeps_unused
        self._records_contacts = keeps_all or "contacts" in needs
        self.needs_next_step = plan.integrator == "implicit" and (
            keeps_all or "velocities" in needs
        )
        self._counts_rotations = any(one.quantity == "angles" for one in of_objects)
        self._time_step = plan.time_step
        self._steps: list[int] = []
        self._contacts: list[Sequence[ContactPoint]] = []
        self._complete_rows = 0
        self.written = 0

    @property
    def is_full(self) -> bool:
        """Whether it is time to flush."""
        return len(self._steps) >= self._capacity

    def count_rotations(self) -> None:
        """Count rotations of objects, at the monitoring interval, wherever rows fall."""
        if self._counts_rotations:
            for one in self._objects:
                one.count_rotation()

    def take(self, step: int) -> None:
        """Keep the present state for the row of a step."""
        if self._records_contacts:
            self._contacts.append(self._world.contact_points() if step > 0 else ())
        row = len(self._steps)
        for part in self._parts:
            part.take(row)
        self._steps.append(step)

    def complete(self) -> None:
        """Complete the last row with the velocities of the next step, if a column needs them."""
        if self.needs_next_step:
            for part in self._parts_with_velocities:
                part.complete(self._complete_rows)
        self._complete_rows += 1

    def flush(self) -> None:
        """Write every complete row, in the order of the header.

        Raises SimulationDiverged for the first invalid row; the rows before it are written.
        """
        steps = self._steps[: self._complete_rows]
        rows = len(steps)
        histories = [body.history(rows) for body in self._bodies]
        valid = self._divergence_monitor.count_valid_rows(rows, histories)
        table: Array = np.empty((self._width, valid))
        # 0.018, not 0.018000000000000002
        table[0] = [float(f"{step * self._time_step:.12g}") for step in steps[:valid]]
        for part in self._parts:
            part.fill(table, self._contacts[:valid])
            part.clear()
        self._steps, self._contacts, self._complete_rows = [], [], 0
        # an object whose state is NaN ends the run at the next check
        is_finite = np.isfinite(table[self._first_of_objects :]).all(axis=0)
        written = valid if is_finite.all() else int(is_finite.argmin())
        self.written += written
        if written:
            self._write(table[:, :written].T)
        if valid < rows:
            self._divergence_monitor.raise_diverged(steps[valid], histories, valid)
