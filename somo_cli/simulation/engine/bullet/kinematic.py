"""Prescribed motion in PyBullet: a base moved by a constraint, and an object of infinite mass.

A constraint moves the base, because the engine then takes its acceleration into account and passes
it on to the joints. An object is a body of infinite mass whose velocity is set.
"""

from __future__ import annotations

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.engine.bullet.body import BulletBody
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.rigid_object import BulletObject
from somo_cli.simulation.plan.model import Body, PlannedObject

CONSTRAINT_ERP = 0.2  # seen in 3.2.7: in one step a constraint takes away this much of its error
MAX_IMPULSE = 1e12  # engine units of impulse; a constraint gives way beyond 500 of them


class PrescribedBody(BulletBody):
    """A manipulator whose base follows a prescribed motion to rounding, whatever acts on it."""

    def __init__(self, engine: BulletClient, body: Body, gravity: Vector, path: str) -> None:
        self._constraint = -1
        super().__init__(engine, body, gravity, path)

    def move_base(self, goal: Pose, is_at_rest: bool) -> None:
        """Move the base frame to this pose in the next step; hold it there if it is at rest."""
        present = self.base_inertial_pose()
        centre, axes = present.position, present.rotation
        way = geometry.subtract(goal.point(self._com_in_base), centre)
        turned = geometry.multiply(goal.rotation, self._inertial_in_base)
        turn = geometry.rotation_vector(geometry.multiply(geometry.transposed(axes), turned))
        # a target beyond the goal is good for one step, the goal itself for many
        share = 1.0 if is_at_rest else CONSTRAINT_ERP
        x, y, z = (value / share for value in way)
        # the error is measured as the angles of Rz Ry Rx about the body's own axes
        beyond = geometry.rotation_from_rpy(geometry.vector(value / share for value in turn))
        self.engine.changeConstraint(
            self._constraint,
            geometry.add(centre, (x, y, z)),
            geometry.quaternion_from_rotation(geometry.multiply(axes, beyond)),
        )
        self._gravity_in_base = geometry.rotate(geometry.transposed(axes), self._gravity)
        self._is_tilted = True

    def base_acceleration_torques(self, acceleration: Array) -> Array:
        """Return the joint torques, shape (n,), that an acceleration of the base requires.

        `acceleration`, shape (6,), is the angular one, then that of the centre of mass, in the
        world; the inertia is that of the last `mass_matrix`.
        """
        pull: Array = self.to_base_axes(acceleration) @ self._base_coupling
        return pull

    def _constrain_base(self) -> None:
        # at the centre of mass, of which the engine knows the place to rounding
        centre, orientation = self.engine.getBasePositionAndOrientation(self.index)
        self._constraint = self.engine.createConstraint(
            self.index,
            -1,
            -1,
            -1,
            self.engine.JOINT_FIXED,
            [0, 0, 0],
            [0, 0, 0],
            centre,
            [0, 0, 0, 1],
            orientation,
        )
        self.engine.changeConstraint(self._constraint, maxForce=MAX_IMPULSE)


class KinematicObject(BulletObject):
    """An object that follows a prescribed motion, whatever acts on it, at a true velocity."""

    def __init__(self, engine: BulletClient, planned: PlannedObject, path: str) -> None:
        self._velocity = (geometry.ZERO, geometry.ZERO)
        super().__init__(engine, planned, path)

    def move_to(self, goal: Pose, time_step: float) -> None:
        """Move the frame to this pose in the next step."""
        goal = self.to_engine(goal)
        centre, orientation = self._engine_pose()
        axes = geometry.rotation_from_quaternion(orientation)
        way = geometry.subtract(goal.position, centre)
        # seen in 3.2.7: the pose of a fixed base is advanced by its velocity all the same, which
        # is that of the centre of mass
        turn = geometry.rotation_vector(geometry.multiply(goal.rotation, geometry.transposed(axes)))
        way = _before_turning(way, turn)
        self._velocity = (_divided(way, time_step), _divided(turn, time_step))
        self.engine.resetBaseVelocity(self.index, *self._velocity)

    def hold_pose(self) -> None:
        """Hold the frame at its present pose until the next `move_to`."""
        self._velocity = (geometry.ZERO, geometry.ZERO)
        self.engine.resetBaseVelocity(self.index, *self._velocity)

    def reset(
        self, linear_velocity: Vector | None = None, principal_rate: Vector | None = None
    ) -> None:
        """Put the object at its start; its velocity stays the one that was set last."""
        super().reset(linear_velocity, principal_rate)
        self.engine.resetBaseVelocity(self.index, *self._velocity)


def _before_turning(way: Vector, turn: Vector) -> Vector:
    """Return the displacement w for which w + turn x w is the wanted one.

    Seen in 3.2.7: the engine adds spin x velocity to the acceleration of a fixed base that moves
    and rotates, which displaces it by h² times that in each step.
    """
    if turn == geometry.ZERO or way == geometry.ZERO:
        return way
    along = geometry.scaled(turn, geometry.dot(turn, way))
    sum_of_both = geometry.add(geometry.subtract(way, geometry.cross(turn, way)), along)
    return _divided(sum_of_both, 1 + geometry.dot(turn, turn))


def _divided(vector: Vector, time: float) -> Vector:
    x, y, z = vector
    return (x / time, y / time, z / time)
