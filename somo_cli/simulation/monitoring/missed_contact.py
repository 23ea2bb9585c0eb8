"""Finds motion so fast that contact may be missed: a part that jumps over another in one step.

The engine looks for contact once a step. What moves, from one step to the next, by as much as two
parts are thick may be on the far side before it was ever near.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Link
from somo_cli.manipulator.kinematics import Pose, reach_of
from somo_cli.simulation.engine.interface import World, WorldObject
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.monitoring.findings import Finding
from somo_cli.simulation.monitoring.penetration import thickness_of
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of

LARGEST_JUMP = 0.5
"""In a step, of the sum of both thicknesses: then two parts that cross overlap in two steps."""


@dataclass(frozen=True, slots=True)
class _Object:
    """An object with a shape; `radius` is that of a ball about its frame [engine units]."""

    name: str
    world_object: WorldObject
    thickness: float
    radius: float


class _Body:
    """A manipulator with shapes, and how fast its links move past a place."""

    def __init__(self, stepper: BodyStepper, step: float) -> None:
        chain = stepper.body.chain
        self.name = stepper.body.name
        self.reach = reach_of(chain)
        # a link without a shape meets nothing, however it moves
        self.thickness: Array = np.array([thickness_of(link) for link in chain.links])
        self.radii: Array = np.array([_radius(link) for link in chain.links])
        self.thinnest = float(self.thickness.min())
        self._stepper = stepper
        self._step = step

    def largest_jump(self) -> float:
        """Return a bound on how far any link moves in a step."""
        reach = self.reach * self._stepper.max_rate
        if self._stepper.body.has_moving_base:
            velocity, spin = self._stepper.world_body.base_velocity()
            reach += geometry.norm(velocity) + self.reach * geometry.norm(spin)
        return self._step * reach

    def link_motion(self) -> tuple[Array, Array]:
        """Return the centres of all links and how far they move in a step, both (links, 3)."""
        stepper, step = self._stepper, self._step
        angles, rates, base = stepper.law.angles, stepper.rates, stepper.world_body.base_pose()
        velocity, spin = stepper.world_body.base_velocity()
        turned = geometry.IDENTITY
        if any(spin):
            turned = geometry.rotation_about(geometry.unit(spin), step * geometry.norm(spin))
        position = geometry.add(base.position, geometry.scaled(velocity, step))
        next_base = Pose(position, geometry.multiply(turned, base.rotation))
        centres = stepper.dynamics().at(angles, base).centres
        return centres, stepper.dynamics().at(angles + step * rates, next_base).centres - centres


class MissedContactMonitor:
    """Compares how objects and bodies near each other move in a step with their thickness."""

    def __init__(self, plan: Plan, world: World, steppers: Sequence[BodyStepper]) -> None:
        self._plan = plan
        self._objects = [
            _Object(
                planned.rigid_object.name,
                world_object,
                thickness_of(planned.rigid_object.chain.links[0]),
                _radius(planned.rigid_object.chain.links[0]),
            )
            for planned, world_object in zip(plan.objects, world.objects, strict=True)
            if planned.rigid_object.chain.links[0].shapes
        ]
        self._bodies = [
            _Body(stepper, plan.time_step)
            for stepper in steppers
            if any(link.shapes for link in stepper.body.chain.links)
        ]
        self.findings: dict[tuple[str, str], Finding] = {}

    def update(self, time: float) -> None:
        """Compare at a check, at a time [s]."""
        step = self._plan.time_step
        jumps = [(body, body.largest_jump()) for body in self._bodies]
        motions = [geometry.scaled(one.world_object.velocity()[0], step) for one in self._objects]
        for number, (one, moved) in enumerate(zip(self._objects, motions, strict=True)):
            jump = geometry.norm(moved)
            for body, body_jump in jumps:
                if jump + body_jump > LARGEST_JUMP * (one.thickness + body.thinnest):
                    self._compare_body(time, body, one, moved)
            if jump > LARGEST_JUMP * one.thickness:
                for other, motion in zip(
                    self._objects[:number] + self._objects[number + 1 :],
                    motions[:number] + motions[number + 1 :],
                    strict=True,
                ):
                    self._compare_object(time, (one, other), geometry.subtract(moved, motion))

    def _compare_body(self, time: float, body: _Body, one: _Object, moved: geometry.Vector) -> None:
        if (body.name, one.name) in self.findings:
            return
        centre = one.world_object.centre()
        centres, steps = body.link_motion()
        jumps = np.linalg.norm(steps - moved, axis=1)
        near = body.radii + one.radius + MONITORING_INTERVAL * jumps
        is_near = np.linalg.norm(centres - centre, axis=1) <= near
        thickness = body.thickness + one.thickness
        excess = np.where(is_near, jumps / thickness, 0.0)
        link = int(excess.argmax())
        if excess[link] > LARGEST_JUMP:
            self._find(time, (body.name, one.name), float(jumps[link]), float(thickness[link]))

    def _compare_object(
        self, time: float, both: tuple[_Object, _Object], moved: geometry.Vector
    ) -> None:
        one, other = both
        jump, thickness = geometry.norm(moved), one.thickness + other.thickness
        apart = geometry.subtract(one.world_object.centre(), other.world_object.centre())
        is_near = geometry.norm(apart) <= one.radius + other.radius + MONITORING_INTERVAL * jump
        is_new = (other.name, one.name) not in self.findings
        if is_near and is_new and jump > LARGEST_JUMP * thickness:
            self._find(time, (one.name, other.name), jump, thickness)

    def _find(self, time: float, names: tuple[str, str], jump: float, thickness: float) -> None:
        metre = unit_factors_of(self._plan).length
        largest = self._plan.time_step * LARGEST_JUMP * thickness / jump
        finding = Finding(
            "contact-missed",
            time,
            names,
            f"at {time:.4g} s '{names[0]}' and '{names[1]}' are near each other and move by "
            f"{1e3 * jump / metre:.3g} mm against each other in one step, where both together are "
            f"{1e3 * thickness / metre:.3g} mm thick: one may pass through the other",
            f"take a step of at most {largest:.1g} s",
            (("motion_in_a_step_m", jump / metre), ("thickness_m", thickness / metre)),
        )
        self.findings.setdefault(names, finding)


def _radius(link: Link) -> float:
    """Return the radius of a ball about the centre of mass that holds all shapes of a link."""
    return max(
        (
            shape.solid.circumradius
            + geometry.norm(geometry.subtract(shape.position, link.inertial.centre))
            for shape in link.shapes
        ),
        default=0.0,
    )
