"""One object in PyBullet: loading, releasing, its motion and what touches it."""

from __future__ import annotations

from typing import Any

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.simulation.bullet_body import contact_force
from somo_cli.simulation.plan import PlannedThing


class BulletThing:
    """One object in the engine, engine units. Its frame is at its centre of mass."""

    def __init__(self, bullet: Any, client: int, planned: PlannedThing, path: str) -> None:
        self._bullet = bullet
        self._client = client
        self._thing = planned.thing
        flags = bullet.URDF_USE_INERTIA_FROM_FILE | bullet.URDF_USE_IMPLICIT_CYLINDER
        self.index: int = bullet.loadURDF(
            path, useFixedBase=self._thing.is_held, flags=flags, physicsClientId=client
        )
        bullet.changeDynamics(
            self.index,
            -1,
            linearDamping=0,
            angularDamping=0,
            lateralFriction=self._thing.surface.friction,
            physicsClientId=client,
        )
        mass = bullet.getDynamicsInfo(self.index, -1, client)[0]
        wanted = self._thing.chain.links[0].inertial.mass
        if not self._thing.is_held and abs(mass - wanted) > 1e-9 * wanted:
            raise EngineRefused(self._thing.name, f"its mass is {mass:g} in the engine")
        self.reset()

    def reset(self, linear_velocity: Vector | None = None) -> None:
        """Put the object at its start, with another velocity if given."""
        thing = self._thing
        rotation = geometry.rotation_from_rpy(thing.rpy)
        self._bullet.resetBasePositionAndOrientation(
            self.index,
            thing.position,
            geometry.quaternion_from_rotation(rotation),
            self._client,
        )
        self._bullet.resetBaseVelocity(
            self.index,
            linear_velocity or thing.linear_velocity,
            thing.angular_velocity,
            physicsClientId=self._client,
        )

    def pose(self) -> Pose:
        """Return the pose of the object's frame in the world."""
        position, turn = self._bullet.getBasePositionAndOrientation(self.index, self._client)
        return Pose(position, geometry.rotation_from_quaternion(turn))

    def linear_velocity(self) -> Vector:
        """Return the velocity of its centre."""
        linear, _ = self._bullet.getBaseVelocity(self.index, self._client)
        return (linear[0], linear[1], linear[2])

    def contact_force(self) -> tuple[float, float, float, float]:
        """Return the force on it of all that touches it, and the sum of the normal forces."""
        return contact_force(self._bullet, self._client, self.index)
