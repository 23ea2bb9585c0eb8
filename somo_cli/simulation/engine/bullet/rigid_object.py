"""One object in PyBullet: loading, releasing, its motion and what touches it."""

from __future__ import annotations

from typing import Any

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.simulation.engine.bullet import compound as bullet_compound
from somo_cli.simulation.engine.bullet.body import UNLIMITED_RATE
from somo_cli.simulation.engine.bullet.contact_parameters import settings
from somo_cli.simulation.plan.model import PlannedThing


class BulletThing:
    """One object in the engine, engine units. `path` is that of a URDF file, if it has one."""

    def __init__(self, bullet: Any, client: int, planned: PlannedThing, path: str) -> None:
        self._bullet = bullet
        self._client = client
        self._thing = planned.thing
        self._principal = planned.compound.frame if planned.compound else None
        if planned.compound:
            stem, has_prescribed_pose = path.removesuffix(".urdf"), self._thing.has_prescribed_pose
            self.index = bullet_compound.load(
                bullet, client, planned.compound, stem, has_prescribed_pose
            )
        else:
            flags = bullet.URDF_USE_INERTIA_FROM_FILE | bullet.URDF_USE_IMPLICIT_CYLINDER
            self.index = bullet.loadURDF(
                path,
                useFixedBase=self._thing.has_prescribed_pose,
                flags=flags,
                physicsClientId=client,
            )
        bullet.changeDynamics(
            self.index,
            -1,
            linearDamping=0,
            angularDamping=0,
            # seen in 3.2.7: no coordinate's rate may be above 100, a base's included
            maxJointVelocity=UNLIMITED_RATE,
            **settings(self._thing.surface),
            physicsClientId=client,
        )
        mass = bullet.getDynamicsInfo(self.index, -1, client)[0]
        wanted = self._thing.chain.links[0].inertial.mass
        if not self._thing.has_prescribed_pose and abs(mass - wanted) > 1e-9 * wanted:
            raise EngineRefused(self._thing.name, f"its mass is {mass:g} in the engine")
        self.reset()

    def reset(self, linear_velocity: Vector | None = None) -> None:
        """Put the object at its start, with another velocity if given."""
        thing = self._thing
        start = self.to_engine(Pose(thing.position, geometry.rotation_from_rpy(thing.rpy)))
        self._bullet.resetBasePositionAndOrientation(
            self.index,
            start.position,
            geometry.quaternion_from_rotation(start.rotation),
            self._client,
        )
        self._bullet.resetBaseVelocity(
            self.index,
            linear_velocity or thing.linear_velocity,
            thing.angular_velocity,
            physicsClientId=self._client,
        )

    def to_engine(self, frame: Pose) -> Pose:
        """Return what the engine takes for a pose of the object's frame: that of its axes."""
        if not self._principal:
            return frame
        rotation = geometry.multiply(frame.rotation, self._principal.rotation)
        return Pose(frame.point(self._principal.position), rotation)

    @property
    def axes(self) -> Matrix | None:
        """The axes of the object's frame in the engine's, None if they are the same."""
        return geometry.transposed(self._principal.rotation) if self._principal else None

    def pose(self) -> Pose:
        """Return the pose of the object's frame in the world."""
        position, turn = self._bullet.getBasePositionAndOrientation(self.index, self._client)
        rotation = geometry.rotation_from_quaternion(turn)
        if self._principal:
            # the engine tells the pose of the principal axes
            rotation = geometry.multiply(rotation, geometry.transposed(self._principal.rotation))
            offset = geometry.rotate(rotation, self._principal.position)
            position = geometry.subtract(position, offset)
        return Pose(position, rotation)

    def velocity(self) -> tuple[Vector, Vector]:
        """Return the velocity of its centre and its angular velocity, in the world."""
        linear, angular = self._bullet.getBaseVelocity(self.index, self._client)
        return linear, angular
