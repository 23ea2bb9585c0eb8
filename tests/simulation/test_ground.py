"""Bodies on the ground: weight, friction and statics, against the laws that everybody knows."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import Data
from tests.builders.runs import rows_of
from tests.builders.scene_problems import messages_of
from tests.builders.scenes import scene_from_file, scene_from_text

pytest.importorskip("pybullet")

G = 9.81  # m/s²
MASS = 0.05  # kg


def block(stiffness: float = 10.0, **of_scene: Any) -> Data:
    """Return a scene of a low block of two halves, a stiff hinge between them, on the ground."""
    link = {"shape_type": "box", "dimensions": [0.05, 0.05, 0.02], "mass": MASS}
    joint = {"joint_type": "continuous", "spring_stiffness": stiffness, "spring_damping": 0.05}
    actuator = {"n_segments": 1, "link_definition": link, "joint_definitions": [joint]}
    definition = {
        "manipulator_name": "block",
        "world_scale": 20,
        "actuator_definitions": [actuator],
    }
    one = {"definition": definition, "base": "free", **of_scene.pop("one", {})}
    record = {"every": 10, "columns": ["base_pose", "contact_force"]}
    return {"ground": {}, "manipulators": [one], "record": record, **of_scene}


def base_and_force(scene: Scene, time: float) -> dict[str, np.ndarray]:
    """Return position of the base and contact force over time, by the last part of the name."""
    rows = np.array(rows_of(scene, round(time / scene.time_step)))
    names = ("t", "x", "y", "z", "qx", "qy", "qz", "qw", "fx", "fy", "fz", "normal")
    return dict(zip(names, rows.T, strict=True))


def base_and_force_of_data(data: Data, time: float = 1.0) -> dict[str, np.ndarray]:
    return base_and_force(scene_from_text(json.dumps(data)), time)


@pytest.mark.parametrize("step", [5e-4, 2e-3])
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_the_ground_carries_the_weight(step: float, integrator: str) -> None:
    found = base_and_force_of_data(block(time_step=step, integrator=integrator), 0.4)
    assert found["fz"][-1] == pytest.approx(MASS * G, rel=1e-6)
    assert found["normal"][-1] == pytest.approx(MASS * G, rel=1e-6)
    assert [found["fx"][-1], found["fy"][-1]] == pytest.approx([0, 0], abs=1e-6)
    assert np.abs(found["z"]).max() < 1e-4
    # nothing has touched it before the first step
    assert found["fz"][0] == 0


@pytest.mark.moderate
@pytest.mark.parametrize("stiffness", [10.0, 1e5])
@pytest.mark.parametrize("step", [2e-3, 5e-4])
@pytest.mark.parametrize(("own", "grounds"), [(0.2, 1.0), (0.5, 1.0), (0.5, 0.4)])
def test_friction_stops_what_slides(
    stiffness: float, step: float, own: float, grounds: float
) -> None:
    speed = 0.5
    one = {"linear_velocity": [speed, 0, 0], "surface": {"friction": own}}
    found = base_and_force_of_data(
        block(stiffness, one=one, ground={"friction": grounds}, time_step=step)
    )
    distance = speed**2 / (2 * own * grounds * G)
    assert found["x"][-1] == pytest.approx(distance, rel=1e-4)
    assert abs(found["y"][-1]) < 1e-4
    assert found["z"].min() > -1e-5
    # while it slides it is held back by what friction can do
    early = found["t"] < 0.5 * speed / (own * grounds * G)
    held = found["fx"][early][1:]
    assert held == pytest.approx(-own * grounds * MASS * G, rel=1e-3)


@pytest.mark.parametrize("slope", [20, 30])
def test_a_block_stays_on_a_slope_below_the_angle_of_friction(slope: float) -> None:
    angle, friction = math.radians(slope), 0.5
    gravity = [G * math.sin(angle), 0, -G * math.cos(angle)]
    found = base_and_force_of_data(block(gravity=gravity, one={"surface": {"friction": friction}}))
    if math.tan(angle) < friction:
        assert abs(found["x"][-1]) < 1e-5
        assert found["fx"][-1] == pytest.approx(-MASS * G * math.sin(angle), rel=1e-3)
    else:
        pull = G * (math.sin(angle) - friction * math.cos(angle))
        assert found["x"][-1] == pytest.approx(pull / 2, rel=0.01)


def test_a_ground_may_be_lower_or_slippery() -> None:
    one = {"position": [0, 0, -0.3], "linear_velocity": [0.5, 0, 0]}
    found = base_and_force_of_data(block(one=one, ground={"height": -0.3, "friction": 0}))
    assert found["z"][-1] == pytest.approx(-0.3, abs=1e-5)
    assert found["x"][-1] == pytest.approx(0.5, rel=1e-3)


def test_without_a_ground_nothing_is_loaded_that_could_touch() -> None:
    data = block()
    assert "<collision>" in make_plan(scene_from_text(json.dumps(data))).bodies[0].urdf
    del data["ground"]
    assert "<collision>" not in make_plan(scene_from_text(json.dumps(data))).bodies[0].urdf
    found = base_and_force_of_data(data, 0.2)
    assert found["z"][-1] == pytest.approx(-G * 0.2**2 / 2, rel=1e-6)
    assert found["fz"][-1] == 0


@pytest.mark.slow
def test_a_finger_that_presses_on_the_ground_stands_where_statics_say() -> None:
    # level above the ground and bent until its tip presses on it: forces at several steps agree
    one = "manipulators[0]"
    forces = []
    for step in (5e-4, 1e-3, 2e-3):
        scene = scene_from_file(
            "scene.yaml",
            "ground={}",
            f"time_step={step}",
            f"{one}.rpy=[1.5707963267948966, 0, 0]",
            f"{one}.position=[0, 0, 0.05]",
            f"{one}.actuation=[{{actuator: 0, axis: 0, waypoints: [[0, 0], [0.3, 0.05]]}}]",
            f"{one}.definition.actuator_definitions[0].joint_definitions[0].spring_damping=0.005",
            "record={every: 10, columns: [base_pose, contact_force]}",
        )
        found = base_and_force(scene, 1.5)
        last = found["t"] > 1.4
        forces.append(float(found["normal"][last].mean()))
        assert found["normal"][last].std() < 1e-3 * forces[-1]
    assert forces[0] > 0.1
    assert forces == pytest.approx([forces[0]] * 3, rel=0.01)


def test_two_bodies_press_on_each_other_with_one_force() -> None:
    # two fingers side by side bend towards each other until they meet
    def finger(name: str, y: float, yaw: float) -> Data:
        drive = {"actuator": 0, "axis": 0, "waypoints": [[0, 0], [0.2, 0.02]]}
        return {
            "name": name,
            "definition": "finger.yaml",
            "position": [0, y, 0],
            "rpy": [0, 0, yaw],
            "actuation": [drive],
        }

    data = {
        "gravity": [0, 0, 0],
        "manipulators": [finger("a", 0.02, 0), finger("b", -0.02, math.pi)],
        "record": {"every": 1, "columns": ["contact_force"]},
    }
    rows = np.array(rows_of(scene_from_text(json.dumps(data)), 600))
    one, other = rows[:, 1:5], rows[:, 5:9]
    assert one[-1, 3] > 0.01
    assert one[:, 3] == pytest.approx(other[:, 3], abs=1e-12)
    assert one[:, :3] == pytest.approx(-other[:, :3], abs=1e-9)


@pytest.mark.slow
def test_a_snake_wriggles_on_the_ground_alike_at_every_step() -> None:
    ends = []
    for step in (1e-3, 2e-3):
        scene = scene_from_file(
            "snake_scene.yaml",
            "ground={}",
            "gravity=[0, 0, -9.81]",
            "manipulators[0].position=[-0.4, 0, 0.02]",
            f"time_step={step}",
            "record={every: 20, columns: [base_pose, contact_force]}",
        )
        found = base_and_force(scene, 0.4)
        weight = sum(link.inertial.mass for link in scene.manipulators[0].compiled.chain.links)
        assert found["normal"][-5:].mean() == pytest.approx(weight * G, rel=0.02)
        assert found["z"].min() > 0.0195
        ends.append([found["x"][-1], found["y"][-1]])
    assert ends[0] == pytest.approx(ends[1], abs=4e-3)


def test_a_start_inside_the_ground_is_reported() -> None:
    assert messages_of(block()) == []
    assert messages_of(block(one={"position": [0, 0, -1e-6]})) == []
    deep = messages_of(block(one={"position": [0, 0, -0.01]}))
    assert deep == ["link 'base' starts 0.01 m inside the ground"]
    # upside down the tip is the lowest
    over = messages_of(block(one={"rpy": [math.pi, 0, 0]}))
    assert over == ["link 'actuator_0_segment_01' starts 0.02 m inside the ground"]
    # a base that is held cannot collide with the ground
    assert messages_of(block(one={"position": [0, 0, -0.005], "base": "static"})) == []
    bent = messages_of(block(one={"initial_angles": 1.5}))
    assert len(bent) == 1
    assert messages_of(block(ground={"height": 1}))[0].endswith("starts 1 m inside the ground")
