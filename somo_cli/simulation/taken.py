"""What was taken of bodies and objects in several steps, and the columns made of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation import columns, readings, thing_readings
from somo_cli.simulation.columns import Group, ThingGroup
from somo_cli.simulation.plan import Plan, others_of
from somo_cli.simulation.poses import ChainPoses
from somo_cli.simulation.readings import States
from somo_cli.simulation.runner import Runner
from somo_cli.simulation.thing_readings import ThingStates
from somo_cli.simulation.touching import Touch
from somo_cli.simulation.turning import TurnCounter
from somo_cli.simulation.units import Units
from somo_cli.simulation.watch import Past
from somo_cli.simulation.world import WorldThing

_PLACED = frozenset({"pose", "angles"})
_STILL = (geometry.ZERO, geometry.ZERO)


class BodyRows:
    """The columns of one manipulator, and its states in all rows, for the watch.

    There is room for `most` rows.
    """

    def __init__(
        self,
        plan: Plan,
        number: int,
        runner: Runner,
        groups: Sequence[Group],
        units: Units,
        most: int,
    ) -> None:
        self._runner = runner
        self._law = runner.law
        self._gravity = plan.gravity
        self._number, self._others = number, others_of(plan, number)
        self._units = units
        kinds = {group.quantity for group in groups}
        can_move = runner.body.base != "static"
        # a base that can move is read at every row's step, any other once
        is_base_told = not kinds.isdisjoint(columns.OF_BASE)
        self._has_base = can_move and is_base_told
        self._base = runner.world_body.base_pose() if is_base_told else Pose()
        self._has_velocity = can_move and "energy" in kinds
        self.has_velocities = not columns.OF_RATES.isdisjoint(kinds)
        """Whether any column needs those of the instant."""
        self._is_early = self.has_velocities and plan.integrator == "implicit"
        self._has_actuation = "actuation" in kinds
        self._poses = ChainPoses(runner.body.chain)
        self._groups = groups
        # angles and rates, as the law has them one behind the other
        self._motion = runner.law.motion
        count = len(runner.law.rates)
        self._motions: Array = np.empty((most, 2 * count))
        self._rates_after: Array = np.empty((most, count))
        self._actuation: Array = np.empty((most, count))
        self.clear()

    def clear(self) -> None:
        """Forget what was taken."""
        self._masses: list[Array] = []
        self._bases: list[Pose] = []
        self._velocities: list[tuple[Vector, Vector]] = []
        self._velocities_after: list[tuple[Vector, Vector]] = []

    def take(self, row: int) -> None:
        """Take the present state for a row."""
        runner = self._runner
        self._motions[row] = self._motion
        self._masses.append(runner.mass)
        if self._has_actuation:
            self._actuation[row] = runner.actuation
        if self._has_base:
            self._bases.append(runner.world_body.base_pose())
        if self._has_velocity:
            self._velocities.append(runner.world_body.base_velocity())

    def complete(self, row: int) -> None:
        """Take the velocities half a step after the state of a row, the last that was taken."""
        self._rates_after[row] = self._law.rates
        if self._has_velocity:
            self._velocities_after.append(self._runner.world_body.base_velocity())

    def past(self, rows: int) -> Past:
        """Return the first so many states, for the watch."""
        count = len(self._law.rates)
        motions = self._motions[:rows]
        return Past(motions[:, :count], motions[:, count:], self._masses[:rows])

    def fill(self, table: Array, touches: Sequence[Sequence[Touch]]) -> None:
        """Write the columns, shape (columns, rows), for as many rows as the table has."""
        rows = table.shape[1]
        if not (rows and self._groups):
            return
        past = self.past(rows)
        rates = past.rates
        if self._is_early:
            rates = 0.5 * (rates + self._rates_after[:rows])
        states = States(
            self._runner.body,
            past.angles.T,
            rates.T,
            self._actuation[:rows].T,
            self._bases[:rows] or [self._base],
            means(self._velocities[:rows], self._velocities_after) or [_STILL] * rows,
            self._gravity,
            self._poses,
            self._runner.dynamics,
            self._number,
            self._others,
            touches,
        )
        for group in self._groups:
            values = readings.READINGS[group.quantity](states, self._units)
            table[group.first : group.last] = kept_of(group, values)


class ThingRows:
    """The columns of one object."""

    def __init__(
        self, plan: Plan, index: int, thing: WorldThing, groups: Sequence[ThingGroup], units: Units
    ) -> None:
        self._thing = thing
        self._units = units
        self._number = len(plan.bodies) + index
        self._others = others_of(plan, self._number)
        kinds = {group.reading for group in groups}
        self._has_pose = not _PLACED.isdisjoint(kinds)
        self.has_velocities = "velocity" in kinds
        """Whether any column needs those of the instant."""
        self._turns = TurnCounter(thing.pose().rotation) if "angles" in kinds else None
        self._groups = groups
        self.clear()

    def clear(self) -> None:
        """Forget what was taken."""
        self._poses: list[Pose] = []
        self._turned: list[Vector] = []
        self._velocities: list[tuple[Vector, Vector]] = []
        self._velocities_after: list[tuple[Vector, Vector]] = []

    def look(self) -> None:
        """Count the turns since the last look."""
        if self._turns is not None:
            self._turns.look(self._thing.pose().rotation)

    def take(self, row: int) -> None:
        """Take the present state for a row."""
        if self._has_pose:
            pose = self._thing.pose()
            self._poses.append(pose)
            if self._turns is not None:
                self._turned.append(self._turns.at(pose.rotation))
        if self.has_velocities:
            self._velocities.append(self._thing.velocity())

    def complete(self, row: int) -> None:
        """Take the velocities half a step after the state of a row, the last that was taken."""
        self._velocities_after.append(self._thing.velocity())

    def fill(self, table: Array, touches: Sequence[Sequence[Touch]]) -> None:
        """Write the columns, shape (columns, rows), for as many rows as the table has."""
        rows = table.shape[1]
        if not rows:
            return
        states = ThingStates(
            self._number,
            self._others,
            self._poses[:rows],
            means(self._velocities[:rows], self._velocities_after),
            self._turned[:rows],
            touches,
        )
        for group in self._groups:
            values = thing_readings.READINGS[group.reading](states, self._units)
            table[group.first : group.last] = kept_of(group, values)


def kept_of(group: Group | ThingGroup, values: Array) -> Array:
    """Return of the columns of a quantity, shape (columns, rows), those that are kept."""
    return values if group.kept.is_whole else values[list(group.kept.places)]


def means(
    before: Sequence[tuple[Vector, Vector]], after: Sequence[tuple[Vector, Vector]]
) -> list[tuple[Vector, Vector]]:
    """Return the means of velocities half a step before and after, or those before if alone."""
    if not after:
        return list(before)
    return [_mean(*pair) for pair in zip(before, after, strict=False)]


def _mean(before: tuple[Vector, Vector], after: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    (ax, ay, az), (bx, by, bz) = (geometry.add(*pair) for pair in zip(before, after, strict=True))
    return (0.5 * ax, 0.5 * ay, 0.5 * az), (0.5 * bx, 0.5 * by, 0.5 * bz)
