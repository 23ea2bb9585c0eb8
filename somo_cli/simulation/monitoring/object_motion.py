"""The kinetic energy and the rotation of free objects, for the divergence monitor."""

from __future__ import annotations

import math
from dataclasses import dataclass

from somo_cli.simulation.engine.interface import World, WorldObject
from somo_cli.simulation.plan.model import Plan

MAX_ANGLE_PER_STEP = math.pi / 2
"""rad; beyond it the engine turns an object by 12 % less than it should, and its rotation has no
solution of second order. Of a ball, whose rotation needs none, twice as much: its alias begins."""
SLOW_RATE = 10.0  # rad/s: an object that turns slower is never called diverged


@dataclass(slots=True)
class ObjectMotion:
    """One free object in motion, engine units: its kinetic energy and its rate [rad/s].

    `floor` is an energy too small to be called divergence.
    """

    name: str
    world_object: WorldObject
    mass: float
    max_angle: float
    floor: float
    energy: float = 0.0
    rate: float = 0.0

    def measure(self) -> None:
        """Measure energy and rate at the present instant."""
        a, b, c = self.world_object.principal_moments
        wx, wy, wz = self.world_object.principal_rate()
        (vx, vy, vz), _ = self.world_object.velocity()
        self.rate = math.sqrt(wx * wx + wy * wy + wz * wz)
        linear = self.mass * (vx * vx + vy * vy + vz * vz)
        self.energy = 0.5 * (linear + a * wx * wx + b * wy * wy + c * wz * wz)


def motions_of_objects(plan: Plan, world: World) -> list[ObjectMotion]:
    """Return the free objects of a world, not yet measured."""
    return [
        ObjectMotion(
            planned.rigid_object.name,
            world_object,
            planned.rigid_object.chain.links[0].inertial.mass,
            MAX_ANGLE_PER_STEP * (1 if planned.has_gyroscopic_torque else 2),
            0.5 * max(world_object.principal_moments) * SLOW_RATE**2,
        )
        for planned, world_object in zip(plan.objects, world.objects, strict=True)
        if not planned.rigid_object.has_prescribed_pose
    ]
