"""The kinetic energy and the rotation of free objects, for the divergence monitor."""

from __future__ import annotations

import math
from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.simulation.engine.interface import World, WorldObject
from somo_cli.simulation.plan.model import Plan, PlannedObject

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
    max_moment: float
    energy_bound: float = 0.0
    """The energy if it turned about the axis of its largest moment."""
    rate: float = 0.0

    def measure(self) -> None:
        """Measure the rate, and a bound of the energy, at the present instant."""
        (vx, vy, vz), (wx, wy, wz) = self.world_object.velocity()
        square = wx * wx + wy * wy + wz * wz
        self.rate = math.sqrt(square)
        self.energy_bound = 0.5 * (
            self.mass * (vx * vx + vy * vy + vz * vz) + self.max_moment * square
        )

    def energy(self) -> float:
        """Return the energy at the present instant."""
        a, b, c = self.world_object.principal_moments
        x, y, z = self.world_object.principal_rate()
        speed = geometry.norm(self.world_object.velocity()[0])
        return 0.5 * (self.mass * speed * speed + a * x * x + b * y * y + c * z * z)


def motions_of_objects(plan: Plan, world: World) -> list[ObjectMotion]:
    """Return the free objects of a world at the start of a run, not yet measured.

    What starts inside something else is pushed out, by as much as all of its depth in a step; to
    say so is not for the divergence monitor.
    """
    depths: dict[int, float] = {}
    for (one, _), (other, _), depth in world.penetrations() if plan.objects else ():
        for number in (one, other):
            depths[number] = max(depth, depths.get(number, 0.0))
    return [
        _object_at_start(planned, world_object, depths.get(number, 0.0), plan.time_step)
        for number, (planned, world_object) in enumerate(
            zip(plan.objects, world.objects, strict=True), start=len(plan.bodies)
        )
        if not planned.rigid_object.has_prescribed_pose
    ]


def _object_at_start(
    planned: PlannedObject, world_object: WorldObject, depth: float, time_step: float
) -> ObjectMotion:
    rigid_object = planned.rigid_object
    mass = rigid_object.chain.links[0].inertial.mass
    max_moment = max(world_object.principal_moments)
    return ObjectMotion(
        rigid_object.name,
        world_object,
        mass,
        MAX_ANGLE_PER_STEP * (1 if planned.has_gyroscopic_torque else 2),
        0.5 * (max_moment * SLOW_RATE**2 + mass * (depth / time_step) ** 2),
        max_moment,
    )
