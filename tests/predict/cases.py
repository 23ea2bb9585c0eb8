"""The scenes of the bench: the shipped ones, free motion and contact that nobody tuned for."""

from __future__ import annotations

import dataclasses
import random
from dataclasses import dataclass

from somo_cli.loading import scene_of
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from tests.builders.scenes import DEFINITIONS, scene_from_file
from tests.grasp.cases import Grasp
from tests.trust.scenes import random_scenes

SHIPPED_TIME = 0.6  # s
GRASP_TIME = 1.6  # s
LATE_TIME = 1.6  # s
RANDOM = 30
STRIKING = 20
STRIKING_TIME = 0.3  # s
SEED = 5
STEPS = (1e-3, 2e-3)  # s, of the random scenes
ROW = 8e-3  # s


@dataclass(frozen=True, slots=True)
class Case:
    """A scene with its step, and for how long it runs [s]."""

    name: str
    scene: Scene
    duration: float

    @property
    def steps(self) -> int:
        """The number of time steps."""
        return round(self.duration / self.scene.time_step)


TO_TOLERANCE = (
    "scene", "gait_scene", "gauss_finger_scene", "press_scene", "push_scene", "lift_scene",
    "pinch_scene", "blocked_force_scene", "crawler_scene", "turn_scene",
)  # fmt: skip
"""The shipped scenes that are run to a tolerance: three of free motion, seven with contact."""


def to_tolerance() -> list[Case]:
    """Return the scenes that are run to a tolerance."""
    by_name = {case.name: case for case in shipped()}
    return [by_name[name] for name in TO_TOLERANCE]


GRASPS = (
    Grasp(mass_ratio=0.1),
    Grasp(mass_ratio=100.0),
    Grasp(damping_ratio=0.02),
    Grasp("lifted", 4, shape="cube"),
    Grasp("released", 4, shape="cube"),
    Grasp("sliding", 4, shape="cube"),
    Grasp("held", 4, shape="capsule"),
)
"""Those of the grasp bench whose recommended step is held against the step that they need."""


TOUCH_LATE = ("ball_arm_scene", "pinch_scene", "planar_pushing_scene", "push_scene")
"""Shipped scenes where nothing is met in SHIPPED_TIME that would ask for a small step."""


def with_contact() -> list[Case]:
    """Return the shipped scenes where bodies can touch, and a part of the grasp bench."""
    grasps = [Case(one.name, one.scene(1e-3), GRASP_TIME) for one in GRASPS]
    touching = [case for case in shipped() if make_plan(case.scene).can_touch]
    late = [
        dataclasses.replace(case, duration=LATE_TIME) if case.name in TOUCH_LATE else case
        for case in touching
    ]
    return [*late, *grasps]


def cases() -> list[Case]:
    """Return the shipped scenes and thirty random ones, the same each time."""
    return [*shipped(), *untuned()]


def shipped() -> list[Case]:
    """Return every shipped scene, at the step that it has."""
    names = sorted(path.name for path in DEFINITIONS.glob("*scene.yaml"))
    return [
        _case(name.removesuffix(".yaml"), scene_from_file(name), SHIPPED_TIME) for name in names
    ]


def untuned() -> list[Case]:
    """Return random scenes, of contact and of a finger that is driven by random waves."""
    draw = random.Random(SEED)
    found = []
    contact = iter(random_scenes(6 * RANDOM, SEED))
    while len(found) < RANDOM:
        one = next(contact)
        if "dropped" in one.name:  # a snake takes minutes
            found.append(_free(draw, len(found)))
            continue
        scene, _ = scene_of(one.document())
        scene = dataclasses.replace(scene, time_step=draw.choice(STEPS))
        found.append(_case(one.name, scene, one.duration / 2))
    return found


def _free(draw: random.Random, number: int) -> Case:
    scale = 10 ** draw.uniform(-1, 1)
    sets = (
        f"manipulators[0].definition.actuator_definitions[0].n_segments={draw.choice((5, 10, 20))}",
        "manipulators[0].actuation=[{actuator: 0, axis: 0, wave: "
        f"{{amplitude: {0.05 * scale:.4g}, frequency: {10 ** draw.uniform(-0.5, 1.2):.3g}}}}}]",
    )
    scene = scene_from_file("scene.yaml", *sets)
    scene = dataclasses.replace(scene, time_step=draw.choice(STEPS))
    return _case(f"{number:03d}_free", scene, SHIPPED_TIME)


def striking() -> list[Case]:
    """Return fingers whose joints strike limits: driven by random waves, or pressed into them."""
    draw = random.Random(SEED)
    return [_striking(draw, number, bool(number % 2)) for number in range(STRIKING)]


def _striking(draw: random.Random, number: int, is_pressed: bool) -> Case:
    limit = draw.uniform(0.02, 0.25)  # rad
    torque, frequency = 10 ** draw.uniform(-1.3, -0.3), 10 ** draw.uniform(-0.3, 1)
    actuator = "manipulators[0].definition.actuator_definitions[0]"
    wave = f"wave: {{amplitude: {torque:.4g}, frequency: {frequency:.3g}}}"
    drive = f"torque: {torque:.4g}" if is_pressed else wave
    scene = scene_from_file(
        "scene.yaml",
        f"{actuator}.n_segments={draw.choice((5, 10, 20))}",
        f"{actuator}.joint_definitions[0].limits=[{-limit:.4g}, {limit:.4g}, 3, 20]",
        f"manipulators[0].actuation=[{{actuator: 0, axis: 0, {drive}}}]",
    )
    scene = dataclasses.replace(scene, time_step=draw.choice((1e-3, 2e-3, 4e-3)))
    return _case(f"{number:03d}_{'pressed' if is_pressed else 'striking'}", scene, STRIKING_TIME)


def _case(name: str, scene: Scene, duration: float) -> Case:
    every = max(2, 2 * round(ROW / scene.time_step / 2))
    return Case(name, dataclasses.replace(scene, every=every, stop_conditions=()), duration)
