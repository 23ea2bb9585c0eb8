"""Contact at rest and in motion: weight, friction, a pressing finger, over steps."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator

import numpy as np

from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text
from tests.truth.table import Row

G = 9.81  # m/s²
STEPS = (5e-4, 1e-3, 2e-3, 4e-3)  # s
CUBE = {"shape_type": "box", "dimensions": [0.04, 0.04, 0.04], "mass": 0.01, "friction": 0.5}


def last_row(scene: Scene, step: float, time: float) -> dict[str, float]:
    """Return the columns at the end of a run."""
    count = round(time / step)
    plan = make_plan(dataclasses.replace(scene, time_step=step, every=count))
    return dict(zip(columns.header(plan.recorded), rows_of(plan, count)[-1], strict=True))


def with_cubes(*cubes: dict[str, object], **of_scene: object) -> Scene:
    """Return a scene of cubes on the ground, and one manipulator that is far away."""
    one = {"definition": manipulator(actuator(1, X), world_scale=20), "position": [9, 9, 9]}
    objects = [
        {**CUBE, **cube} if "mesh" not in cube else {"friction": 0.5, **cube} for cube in cubes
    ]
    record = {"columns": [], "objects": ["pose", "contact_force"]}
    data = {"ground": {}, "manipulators": [one], "objects": objects, "record": record}
    return scene_from_text(json.dumps({**data, **of_scene}))


def rows() -> Iterator[Row]:
    """Yield every row about contact."""
    start = {"name": "cube", "position": [0, 0, 0.02], "linear_velocity": [0.5, 0, 0]}
    expected = 0.5**2 / (2 * 0.5 * G)
    for step in STEPS:
        found = last_row(with_cubes(start), step, 0.4)["cube.pose.x_m"]
        what = "distance of a cube that friction stops [m], relative error"
        yield Row(
            what, "0.5 m/s, friction 0.5", f"{step:g} s", found, expected, abs(found / expected - 1)
        )
    for slope in (20, 30):
        angle = math.radians(slope)
        pull = max(0.0, G * (math.sin(angle) - 0.5 * math.cos(angle)))
        gravity = [G * math.sin(angle), 0, -G * math.cos(angle)]
        still = {"name": "cube", "position": [0, 0, 0.02]}
        for step in STEPS:
            found = last_row(with_cubes(still, gravity=gravity), step, 0.4)["cube.pose.x_m"]
            expected = pull * 0.4**2 / 2
            what = "distance of a cube down a slope, friction 0.5 (26.6 degrees) [m]"
            yield Row(
                what, f"{slope} degrees", f"{step:g} s", found, expected, abs(found - expected)
            )
    stack = [{"name": f"cube_{n}", "position": [0, 0, 0.02 + 0.04 * n]} for n in range(4)]
    ends = {step: last_row(with_cubes(*stack), step, 1.0) for step in STEPS}
    for step, end in ends.items():
        found = end["cube_3.pose.z_m"]
        what = "height of the top of four cubes after a second [m]"
        yield Row(what, "stack", f"{step:g} s", found, 0.14, abs(found - 0.14))
    for step, end in ends.items():
        borne = [end[f"cube_{n}.contact.normal_n"] / (0.01 * G) for n in range(4)]
        off = float(np.abs(np.array(borne) - (7, 5, 3, 1)).max())
        what = "normal forces on four stacked cubes, in weights of one: largest error"
        yield Row(what, "stack", f"{step:g} s", borne[0], 7, off)
    forces = [
        last_row(scene_from_file("press_scene.yaml"), step, 1.5)["finger.contact.normal_n"]
        for step in STEPS
    ]
    for step, force in zip(STEPS, forces, strict=True):
        what = "force of a finger that presses on the ground [N], relative to the finest step"
        yield Row(
            what, "press_scene.yaml", f"{step:g} s", force, forces[0], abs(force / forces[0] - 1)
        )
