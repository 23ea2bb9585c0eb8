"""Rows of the CSV out of a world in motion: what the columns need is read, and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation import columns
from somo_cli.simulation.pace import STEPS_BETWEEN_LOOKS
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.runner import Runner
from somo_cli.simulation.taken import BodyRows, ThingRows
from somo_cli.simulation.touching import Touch
from somo_cli.simulation.units import units_of
from somo_cli.simulation.watch import Watch
from somo_cli.simulation.world import World

NUMBERS = 16384  # that wait until columns are made of them, which is when that is fastest
ROWS = 256  # that wait, at most, however narrow

Write: TypeAlias = Callable[[Array], None]
"""Takes several rows at once, shape (rows, columns), in SI."""


class Rows:
    """Makes the rows of a plan: `take` keeps the state of a step, `release` writes what was taken.

    With the implicit law velocities live at half steps, and a row has the mean of two;
    `needs_next_step` says whether any of the columns asks for that, and `complete` takes them. The
    columns are made for many rows at once, after the watch has looked at them.
    """

    def __init__(
        self, plan: Plan, world: World, runners: Sequence[Runner], watch: Watch, write: Write
    ) -> None:
        self._world = world
        self._watch = watch
        self._write = write
        units = units_of(plan)
        groups, of_things = columns.groups(plan), columns.thing_groups(plan)
        self._width = len(columns.header(plan))
        self._most = max(1, min(ROWS, NUMBERS // self._width))
        room = self._most + STEPS_BETWEEN_LOOKS  # rows are released at looks
        self._bodies = [
            BodyRows(
                plan, number, runner, [one for one in groups if one.body == number], units, room
            )
            for number, runner in enumerate(runners)
        ]
        self._things = [
            ThingRows(plan, index, thing, of_one, units)
            for index, thing in enumerate(world.things)
            if (of_one := [one for one in of_things if one.thing == index])
        ]
        self._parts: list[BodyRows | ThingRows] = [*self._bodies, *self._things]
        self._completed = [part for part in self._parts if part.has_velocities]
        kinds = {group.quantity for group in groups} | {group.reading for group in of_things}
        keeps_all = plan.keeps_everything
        self._has_touches = keeps_all or not columns.OF_CONTACT.isdisjoint(kinds)
        self.needs_next_step = plan.integrator == "implicit" and (
            keeps_all or not (columns.OF_RATES | {"velocity"}).isdisjoint(kinds)
        )
        self._is_counting = "angles" in kinds
        self._time_step = plan.time_step
        self._steps: list[int] = []
        self._touches: list[Sequence[Touch]] = []
        self._complete = 0
        self.written = 0

    @property
    def is_full(self) -> bool:
        """Whether it is time to release what was taken."""
        return len(self._steps) >= self._most

    def look(self) -> None:
        """Count the turns of objects; at looks, so that it does not matter where rows fall."""
        if self._is_counting:
            for thing in self._things:
                thing.look()

    def take(self, step: int) -> None:
        """Take the present state for the row of a step."""
        if self._has_touches:
            self._touches.append(self._world.touches() if step > 0 else ())
        row = len(self._steps)
        for part in self._parts:
            part.take(row)
        self._steps.append(step)

    def complete(self) -> None:
        """Have the row that was taken last be whole, with velocities of a step later if needed."""
        if self.needs_next_step:
            for part in self._completed:
                part.complete(self._complete)
        self._complete += 1

    def release(self) -> None:
        """Write every complete row, in the order of the header.

        Raises SimulationDiverged for the first that the watch refuses; those before it are written.
        """
        steps = self._steps[: self._complete]
        rows = len(steps)
        pasts = [body.past(rows) for body in self._bodies]
        sound = self._watch.sound(pasts)
        table: Array = np.empty((self._width, sound))
        # 0.018, not 0.018000000000000002
        table[0] = [float(f"{step * self._time_step:.12g}") for step in steps[:sound]]
        for part in self._parts:
            part.fill(table, self._touches[:sound])
            part.clear()
        self._steps, self._touches, self._complete = [], [], 0
        self.written += sound
        if sound:
            self._write(table.T)
        if sound < rows:
            self._watch.refuse(steps[sound], pasts, sound)
