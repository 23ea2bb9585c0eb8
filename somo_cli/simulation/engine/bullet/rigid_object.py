"""One object in PyBullet: loading, releasing, its motion and what touches it."""

from __future__ import annotations

from functools import partial

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.simulation.engine.bullet import collision_filter
from somo_cli.simulation.engine.bullet import compound as bullet_compound
from somo_cli.simulation.engine.bullet.body import UNLIMITED_RATE
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.contact_parameters import surface_settings
from somo_cli.simulation.engine.bullet.object_readback import object_mismatches
from somo_cli.simulation.plan.model import PlannedObject


class BulletObject:
    """One object in the engine, engine units. `path` is that of a URDF file, if it has one."""

    def __init__(self, engine: BulletClient, planned: PlannedObject, path: str) -> None:
        self.engine = engine
        self._object = planned.rigid_object
        self._principal_frame = planned.compound.frame if planned.compound else None
        self.index = _load(engine, planned, path)
        # bound once, because they are called in every step
        module, client = engine.module, engine.number
        self._engine_pose = partial(module.getBasePositionAndOrientation, self.index, client)
        self._engine_velocity = partial(module.getBaseVelocity, self.index, client)
        engine.changeDynamics(
            self.index,
            -1,
            linearDamping=0,
            angularDamping=0,
            # seen in 3.2.7: no coordinate's rate may be above 100, a base's included
            maxJointVelocity=UNLIMITED_RATE,
            **surface_settings(self._object.surface),
        )
        if not self._object.collides:
            collision_filter.disable_collisions(engine, self.index, [-1])
        if not self._object.has_prescribed_pose:
            mismatches = object_mismatches(engine, self.index, planned)
            if mismatches:
                raise EngineRefused(self._object.name, "; ".join(mismatches))
        # seen in 3.2.7: the engine reports the pose of the axes of these moments
        self.principal_moments: Vector = (
            geometry.ZERO
            if self._object.has_prescribed_pose
            else engine.getDynamicsInfo(self.index, -1)[2]
        )
        self.principal_axes: Matrix = (
            self._principal_frame.rotation if self._principal_frame else geometry.IDENTITY
        )
        self.reset()

    def reset(
        self, linear_velocity: Vector | None = None, principal_rate: Vector | None = None
    ) -> None:
        """Put the object at its start, with these velocities if they are given.

        The velocity of its centre is in the world, the angular velocity along its principal axes.
        """
        planned_object = self._object
        start = self.to_engine(planned_object.pose)
        self.engine.resetBasePositionAndOrientation(
            self.index,
            start.position,
            geometry.quaternion_from_rotation(start.rotation),
        )
        angular_velocity = planned_object.angular_velocity
        if principal_rate is not None:
            angular_velocity = geometry.rotate(start.rotation, principal_rate)
        self.engine.resetBaseVelocity(
            self.index,
            linear_velocity or planned_object.linear_velocity,
            angular_velocity,
        )

    def principal_rate(self) -> Vector:
        """Return the angular velocity [rad/s] along the principal axes."""
        _, (x, y, z, w) = self.engine.getBasePositionAndOrientation(self.index)
        _, (vx, vy, vz) = self.engine.getBaseVelocity(self.index)
        # turned by the conjugate, v + 2 q x (q x v - w v): half of the time of a matrix
        tx, ty, tz = y * vz - z * vy - w * vx, z * vx - x * vz - w * vy, x * vy - y * vx - w * vz
        return (
            vx + 2 * (y * tz - z * ty),
            vy + 2 * (z * tx - x * tz),
            vz + 2 * (x * ty - y * tx),
        )

    def apply_principal_torque(self, torque: Vector) -> None:
        """Apply a torque, along the principal axes, during the next step."""
        frame = self.engine.LINK_FRAME
        self.engine.applyExternalTorque(self.index, -1, torque, frame)

    def to_engine(self, frame: Pose) -> Pose:
        """Return the engine's pose, that of the principal axes, for one of the object's frame."""
        return frame.compose(self._principal_frame) if self._principal_frame else frame

    @property
    def axes(self) -> Matrix | None:
        """The axes of the object's frame in the engine's, None if they are the same."""
        return (
            geometry.transposed(self._principal_frame.rotation) if self._principal_frame else None
        )

    def pose(self) -> Pose:
        """Return the pose of the object's frame in the world."""
        position, turn = self._engine_pose()
        rotation = geometry.rotation_from_quaternion(turn)
        if self._principal_frame:
            # the engine reports the pose of the principal axes
            rotation = geometry.multiply(
                rotation, geometry.transposed(self._principal_frame.rotation)
            )
            offset = geometry.rotate(rotation, self._principal_frame.position)
            position = geometry.subtract(position, offset)
        return Pose(position, rotation)

    def mobility(self) -> tuple[Vector, Array]:
        """Return its centre of mass and the inverse of its inertia, (6, 6), in the world."""
        centre, turn = self._engine_pose()
        inverse: Array = np.zeros((6, 6))
        if not self._object.has_prescribed_pose:
            reported = self.engine.getDynamicsInfo(self.index, -1)
            axes = np.array(geometry.rotation_from_quaternion(turn))
            inverse[:3, :3] = axes / np.array(reported[2]) @ axes.T
            inverse[3:, 3:] = np.eye(3) / reported[0]
        return centre, inverse

    def centre(self) -> Vector:
        """Return the position of its centre of mass in the world."""
        position: Vector = self.engine.getBasePositionAndOrientation(self.index)[0]
        return position

    def velocity(self) -> tuple[Vector, Vector]:
        """Return the velocity of its centre and its angular velocity, in the world."""
        linear, angular = self._engine_velocity()
        return linear, angular


def _load(engine: BulletClient, planned: PlannedObject, path: str) -> int:
    """Load an object and return its number; an object that cannot move gets no inertia."""
    is_fixed = planned.rigid_object.has_prescribed_pose
    if planned.compound:
        stem = path.removesuffix(".urdf")
        return bullet_compound.create_body(engine, planned.compound, stem, is_fixed)
    flags = engine.URDF_USE_INERTIA_FROM_FILE | engine.URDF_USE_IMPLICIT_CYLINDER
    index: int = engine.loadURDF(path, useFixedBase=is_fixed, flags=flags)
    return index
