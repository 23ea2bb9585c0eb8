"""Buffers for the states of bodies and objects in several rows, and the columns made of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import columns
from somo_cli.scene.columns import BodyColumnGroup, ObjectColumnGroup
from somo_cli.simulation.dynamics.forward_kinematics import ForwardKinematics
from somo_cli.simulation.dynamics.gyroscopic import mean_rates
from somo_cli.simulation.engine.contacts import ContactPoint
from somo_cli.simulation.engine.interface import WorldObject
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.monitoring.divergence import StateHistory
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import UnitFactors
from somo_cli.simulation.recording import body_values, object_values
from somo_cli.simulation.recording.body_values import BodyStates
from somo_cli.simulation.recording.object_values import ObjectStates
from somo_cli.simulation.recording.rotation_counter import RotationCounter

_NEEDS_POSE = frozenset({"pose", "angles"})
_AT_REST = (geometry.ZERO, geometry.ZERO)


class BodyRowBuffer:
    """The states of one manipulator in at most `capacity` rows, and its columns.

    The divergence monitor checks the states.
    """

    def __init__(
        self,
        plan: Plan,
        number: int,
        body_stepper: BodyStepper,
        groups: Sequence[BodyColumnGroup],
        units: UnitFactors,
        capacity: int,
    ) -> None:
        self._body_stepper = body_stepper
        self._law = body_stepper.law
        self._gravity = plan.gravity
        self._number, self._others = number, plan.recorded.contact_partners(number)
        self._units = units
        kinds = {group.quantity for group in groups}
        can_move = body_stepper.body.base != "static"
        # a base that can move is read at every row's step, any other once
        needs = columns.needs_of(groups)
        needs_base_pose = "base_pose" in needs
        self._records_base_pose = can_move and needs_base_pose
        self._base = body_stepper.world_body.base_pose() if needs_base_pose else Pose()
        self._records_base_velocity = can_move and "base_velocity" in needs
        self.needs_velocities = "velocities" in needs
        """Whether a column needs velocities at the instant of its row."""
        self._averages_rates = self.needs_velocities and plan.integrator == "implicit"
        self._records_actuation = "actuation" in kinds
        self._poses = ForwardKinematics(body_stepper.body.chain)
        self._groups = groups
        # angles and rates one after the other, as in the law's state
        self._motion = body_stepper.law.motion
        count = len(body_stepper.law.rates)
        self._motions: Array = np.empty((capacity, 2 * count))
        self._rates_after: Array = np.empty((capacity, count))
        self._actuation: Array = np.empty((capacity, count))
        self.clear()

    def clear(self) -> None:
        """Forget all rows."""
        self._masses: list[Array] = []
        self._bases: list[Pose] = []
        self._velocities: list[tuple[Vector, Vector]] = []
        self._velocities_after: list[tuple[Vector, Vector]] = []

    def take(self, row: int) -> None:
        """Keep the present state for a row."""
        body_stepper = self._body_stepper
        self._motions[row] = self._motion
        self._masses.append(body_stepper.mass)
        if self._records_actuation:
            self._actuation[row] = body_stepper.actuation.si_torques()
        if self._records_base_pose:
            self._bases.append(body_stepper.world_body.base_pose())
        if self._records_base_velocity:
            self._velocities.append(body_stepper.world_body.base_velocity())

    def complete(self, row: int) -> None:
        """Keep the velocities half a step after the state of the last row."""
        self._rates_after[row] = self._law.rates
        if self._records_base_velocity:
            self._velocities_after.append(self._body_stepper.world_body.base_velocity())

    def history(self, rows: int) -> StateHistory:
        """Return the states of the first rows."""
        count = len(self._law.rates)
        motions = self._motions[:rows]
        return StateHistory(motions[:, :count], motions[:, count:], self._masses[:rows])

    def fill(self, table: Array, contacts: Sequence[Sequence[ContactPoint]]) -> None:
        """Write the columns, shape (columns, rows), for as many rows as the table has."""
        rows = table.shape[1]
        if not (rows and self._groups):
            return
        history = self.history(rows)
        rates = history.rates
        if self._averages_rates:
            rates = 0.5 * (rates + self._rates_after[:rows])
        states = BodyStates(
            self._body_stepper.body,
            history.angles.T,
            rates.T,
            self._actuation[:rows].T,
            self._bases[:rows] or [self._base],
            mean_velocities(self._velocities[:rows], self._velocities_after) or [_AT_REST] * rows,
            self._gravity,
            self._poses,
            self._body_stepper.dynamics,
            self._number,
            self._others,
            contacts,
        )
        for group in self._groups:
            values = body_values.BODY_VALUES[group.quantity](states, self._units)
            table[group.first : group.last] = select_values(group, values)


class ObjectRowBuffer:
    """The states of one object in several rows, and its columns."""

    def __init__(
        self,
        plan: Plan,
        index: int,
        rigid_object: WorldObject,
        groups: Sequence[ObjectColumnGroup],
        units: UnitFactors,
    ) -> None:
        self._object = rigid_object
        self._units = units
        self._number = len(plan.bodies) + index
        self._others = plan.recorded.contact_partners(self._number)
        kinds = {group.quantity for group in groups}
        self.needs_velocities = "velocity" in kinds
        """Whether a column needs velocities at the instant of its row."""
        self._time_step = plan.time_step
        # of a body whose moments differ, the mean momentum at the row's pose tells the rate
        self._averages_momenta = (
            self.needs_velocities
            and plan.integrator == "implicit"
            and plan.objects[index].has_gyroscopic_torque
        )
        self._records_pose = self._averages_momenta or not _NEEDS_POSE.isdisjoint(kinds)
        self._rotation_counter = (
            RotationCounter(rigid_object.pose().rotation) if "angles" in kinds else None
        )
        self._groups = groups
        self.clear()

    def clear(self) -> None:
        """Forget all rows."""
        self._poses: list[Pose] = []
        self._total_rotations: list[Vector] = []
        self._velocities: list[tuple[Vector, Vector]] = []
        self._velocities_after: list[tuple[Vector, Vector]] = []

    def count_rotation(self) -> None:
        """Count the rotation since the last call."""
        if self._rotation_counter is not None:
            self._rotation_counter.update(self._object.pose().rotation)

    def take(self, row: int) -> None:
        """Keep the present state for a row."""
        if self._records_pose:
            pose = self._object.pose()
            self._poses.append(pose)
            if self._rotation_counter is not None:
                self._total_rotations.append(self._rotation_counter.at(pose.rotation))
        if self.needs_velocities:
            self._velocities.append(self._object.velocity())

    def complete(self, row: int) -> None:
        """Keep the velocities half a step after the state of the last row."""
        self._velocities_after.append(self._object.velocity())

    def fill(self, table: Array, contacts: Sequence[Sequence[ContactPoint]]) -> None:
        """Write the columns, shape (columns, rows), for as many rows as the table has."""
        rows = table.shape[1]
        if not rows:
            return
        states = ObjectStates(
            self._number,
            self._others,
            self._poses[:rows],
            self._row_velocities(rows),
            self._total_rotations[:rows],
            contacts,
        )
        for group in self._groups:
            values = object_values.OBJECT_VALUES[group.quantity](states, self._units)
            table[group.first : group.last] = select_values(group, values)

    def _row_velocities(self, rows: int) -> list[tuple[Vector, Vector]]:
        """Return the velocity of its centre and its angular velocity in so many rows."""
        before, after = self._velocities[:rows], self._velocities_after[:rows]
        means = mean_velocities(before, after)
        if not (self._averages_momenta and after):
            return means
        world_object = self._object
        rotations = np.array([pose.rotation for pose in self._poses[:rows]])
        rates = mean_rates(
            world_object.principal_moments,
            rotations @ np.array(world_object.principal_axes),
            np.array([angular for _, angular in before]),
            np.array([angular for _, angular in after]),
            self._time_step,
        )
        own = map(geometry.vector, rates.tolist())
        return [(linear, angular) for (linear, _), angular in zip(means, own, strict=True)]


def select_values(group: BodyColumnGroup | ObjectColumnGroup, values: Array) -> Array:
    """Return the selected columns of a quantity, shape (columns, rows)."""
    return values if group.selection.selects_all else values[list(group.selection.indices)]


def mean_velocities(
    before: Sequence[tuple[Vector, Vector]], after: Sequence[tuple[Vector, Vector]]
) -> list[tuple[Vector, Vector]]:
    """Return the means of velocities half a step before and after; those before without after."""
    if not after:
        return list(before)
    return [_mean_velocity(*pair) for pair in zip(before, after, strict=False)]


def _mean_velocity(
    before: tuple[Vector, Vector], after: tuple[Vector, Vector]
) -> tuple[Vector, Vector]:
    (ax, ay, az), (bx, by, bz) = (geometry.add(*pair) for pair in zip(before, after, strict=True))
    return (0.5 * ax, 0.5 * ay, 0.5 * az), (0.5 * bx, 0.5 * by, 0.5 * bz)
