"""RowAssembler of the CSV out of a world in motion: what the columns need is read, and nothing else."""

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

NUMBERS_PER_BATCH = 16384  # that wait until columns are made of them, which is when that is fastest
MAX_ROWS_PER_BATCH = 256  # that wait, at capacity, however narrow

RowWriter: TypeAlias = Callable[[Array], None]
"""Takes several rows at once, shape (rows, columns), in SI."""


class RowAssembler:
    """Makes the rows of a plan: `take` keeps the state of a step, `flush` writes what was taken.

    With the implicit law velocities live at half steps, and a row has the mean of two;
    `needs_next_step` says whether any of the columns asks for that, and `complete` takes them. The
    columns are made for many rows at once, after the watch has looked at them.
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
        groups, of_things = (
            columns.body_column_groups(plan.recorded),
            columns.object_column_groups(plan.recorded),
        )
        self._width = len(columns.header(plan.recorded))
        self._capacity = max(1, min(MAX_ROWS_PER_BATCH, NUMBERS_PER_BATCH // self._width))
        buffer_size = self._capacity + MONITORING_INTERVAL  # rows are released at looks
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
        self._things = [
            ObjectRowBuffer(plan, index, thing, of_one, units)
            for index, thing in enumerate(world.objects)
            if (of_one := [one for one in of_things if one.object_index == index])
        ]
        self._parts: list[BodyRowBuffer | ObjectRowBuffer] = [*self._bodies, *self._things]
        self._parts_with_velocities = [part for part in self._parts if part.needs_velocities]
        needs = columns.needs_of([*groups, *of_things])
        keeps_all = plan.keeps_unused
        self._records_contacts = keeps_all or "contacts" in needs
        self.needs_next_step = plan.integrator == "implicit" and (
            keeps_all or "velocities" in needs
        )
        self._counts_rotations = any(one.quantity == "angles" for one in of_things)
        self._time_step = plan.time_step
        self._steps: list[int] = []
        self._touches: list[Sequence[ContactPoint]] = []
        self._complete_rows = 0
        self.written = 0

    @property
    def is_full(self) -> bool:
        """Whether it is time to flush what was taken."""
        return len(self._steps) >= self._capacity

    def count_rotations(self) -> None:
        """Count the turns of objects; at looks, so that it does not matter where rows fall."""
        if self._counts_rotations:
            for thing in self._things:
                thing.count_rotation()

    def take(self, step: int) -> None:
        """Take the present state for the row of a step."""
        if self._records_contacts:
            self._touches.append(self._world.contact_points() if step > 0 else ())
        row = len(self._steps)
        for part in self._parts:
            part.take(row)
        self._steps.append(step)

    def complete(self) -> None:
        """Have the row that was taken last be whole, with velocities of a step later if needed."""
        if self.needs_next_step:
            for part in self._parts_with_velocities:
                part.complete(self._complete_rows)
        self._complete_rows += 1

    def flush(self) -> None:
        """Write every complete row, in the order of the header.

        Raises SimulationDiverged for the first that the watch refuses; those before it are written.
        """
        steps = self._steps[: self._complete_rows]
        rows = len(steps)
        histories = [body.history(rows) for body in self._bodies]
        valid = self._divergence_monitor.count_valid_rows(histories)
        table: Array = np.empty((self._width, valid))
        # 0.018, not 0.018000000000000002
        table[0] = [float(f"{step * self._time_step:.12g}") for step in steps[:valid]]
        for part in self._parts:
            part.fill(table, self._touches[:valid])
            part.clear()
        self._steps, self._touches, self._complete_rows = [], [], 0
        self.written += valid
        if valid:
            self._write(table.T)
        if valid < rows:
            self._divergence_monitor.raise_diverged(steps[valid], histories, valid)
