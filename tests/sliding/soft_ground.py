"""Bodies on soft ground that nothing drives: how much energy they win."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from somo_cli.manipulator.solids import Inertial
from somo_cli.scene.model import Scene
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.sliding.headings import BODIES, HEIGHTS
from tests.truth.touching import G, with_cubes

STIFFNESS, DAMPING = 3000.0, 20.0  # N/m, N s/m, of each point of contact
SHAPES: Mapping[str, Mapping[str, Any]] = {
    **BODIES,
    "ball": {"shape_type": "sphere", "dimensions": [0.02], "mass": 0.3},
    "roll": {"shape_type": "cylinder", "dimensions": [0.05, 0.02], "mass": 0.3},
}
STATES: Mapping[str, Mapping[str, Any]] = {
    "rests": {},
    "slides": {"linear_velocity": [0.5, 0.2, 0]},
    "spins": {"angular_velocity": [0, 0, 5]},
    "falls": {"angular_velocity": [0.3, 0.2, 0]},
}
FALL = 0.02  # m


def soft_scene(
    body: str,
    state: str,
    friction: float = 0.35,
    stiffness: float = STIFFNESS,
    damping: float = DAMPING,
) -> Scene:
    """Return a scene of one body on soft ground."""
    lies = body in ("capsule", "roll")
    height = {**HEIGHTS, "ball": 0.02, "roll": 0.02}[body] + (FALL if state == "falls" else 0.0)
    rigid_object = {
        **SHAPES[body],
        **STATES[state],
        "name": "body_of_test",
        "friction": friction,
        "position": [0.0, 0.0, height],
        "rpy": [math.pi / 2, 0.0, 0.4] if lies else [0.0, 0.0, 0.3],
    }
    ground = {"contact_stiffness": stiffness, "contact_damping": damping}
    record = {"columns": [], "objects": ["pose", "velocity"]}
    return with_cubes(rigid_object, ground=ground, record=record)


def won(
    body: str, state: str, step: float, time: float = 1.0, **of_scene: float
) -> tuple[float, float]:
    """Return the energy won again after it was lost, over what there was, and the tilt [degrees].

    The energy is that of motion, height and the springs in the ground; what there was, that of its
    motion at the start or what it lost in all, and what its weight puts into one spring. The tilt
    is the largest of the body's z axis against that at the start.
    """
    scene = soft_scene(body, state, **of_scene)
    plan = make_plan(dataclasses.replace(scene, time_step=step))
    inertial = scene.objects[0].chain.links[0].inertial
    stiffness = of_scene.get("stiffness", STIFFNESS)
    xx, _, _, yy, _, zz = inertial.inertia
    energies: list[float] = []
    ups: list[float] = []
    with BulletWorld(plan) as world:
        rigid_object, take, length = world.objects[0], world.step, plan.scale.length

        def monitored() -> None:
            pose, (velocity, spin) = rigid_object.pose(), rigid_object.velocity()
            take()
            own = np.array(pose.rotation).T @ spin
            motion = inertial.mass * float(np.dot(velocity, velocity)) / length**2
            motion += float(own @ (np.array([xx, yy, zz]) * own))
            springs = sum((depth / length) ** 2 for _, _, depth in world.penetrations())
            energies.append(
                (motion + stiffness * springs) / 2 + inertial.mass * G * pose.position[2] / length
            )
            ups.append(pose.rotation[2][2])

        world.step = monitored
        run.run(plan, world, lambda rows: None, round(time / step), lambda: 0.0)
    course = np.array(energies[1:])
    sunk = (inertial.mass * G) ** 2 / (2 * stiffness)
    had = max(_motion_at_start(inertial, state), float(course[0] - course.min())) + sunk
    gained = float((course - np.minimum.accumulate(course)).max())
    tilts = np.arccos(np.minimum(1.0, np.array(ups)))
    return gained / had, math.degrees(float(np.abs(tilts - tilts[0]).max()))


def _motion_at_start(inertial: Inertial, state: str) -> float:
    velocity = np.array(STATES[state].get("linear_velocity", (0, 0, 0)))
    return float(inertial.mass * velocity @ velocity / 2)
