"""An object that is moved: where it is, and what it carries."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator.geometry import rotate, rotation_from_quaternion, rotation_from_rpy
from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import Data, X, actuator, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

pytest.importorskip("pybullet")

G = 9.81  # m/s²
PARTS = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")


def carried(
    motion: Data, step: float, time: float, every: int | None = None, **of_plate: Any
) -> dict[str, np.ndarray]:
    """Return the poses, (rows, 7), of a plate that is moved and of a cube of 10 g on it.

    There is a row every 0.02 s, or every so many steps.
    """
    plate = {
        "name": "plate",
        "shape_type": "box",
        "dimensions": [0.3, 0.3, 0.02],
        "friction": 1,
        "motion": motion,
        **of_plate,
    }
    cube = {
        "name": "cube",
        "shape_type": "box",
        "dimensions": [0.04, 0.04, 0.04],
        "mass": 0.01,
        "friction": 0.5,
        "position": [0.05, 0, 0],
        "place": {"on": "plate"},
    }
    one = {"definition": manipulator(actuator(1, X), world_scale=20), "position": [9, 9, 9]}
    data = {
        "time_step": step,
        "manipulators": [one],
        "objects": [cube, plate],
        "record": {"every": every or round(0.02 / step), "columns": []},
    }
    plan = make_plan(scene_from_text(json.dumps(data)))
    rows = np.array(rows_of(plan, round(time / step)))
    names = columns.header(plan.recorded)
    return {
        name: rows[:, [names.index(f"{name}.pose.{part}") for part in PARTS]]
        for name in ("cube", "plate")
    }


@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_it_is_where_its_path_says_and_what_lies_on_it_rides_along(step: float) -> None:
    # up to 0.75 m/s and below what friction can do
    path = {"translation": [[0, 0, 0, 0], [1, 0.5, 0, 0.1]]}
    found = carried(path, step, 1.2)
    s = np.minimum(np.arange(len(found["plate"])) * 0.02, 1)
    smooth = 3 * s**2 - 2 * s**3
    expected = np.outer(smooth, [0.5, 0, 0.1])
    assert found["plate"][:, :3] == pytest.approx(expected, abs=1e-12)
    apart = found["cube"][:, :3] - found["plate"][:, :3]
    assert apart == pytest.approx(np.tile([0.05, 0, 0.03], (len(apart), 1)), abs=1e-6)


@pytest.mark.parametrize("end", [0.016, 0.0173, 0.021])
def test_where_rows_fall_changes_nothing_when_it_comes_to_rest(end: float) -> None:
    motion = {"rotation": [[0, 0, 0, 0], [end, 0.1, 0.01, 0.03]], "about": [0.1, 0, 0]}
    every_step = carried(motion, 1e-3, 0.042, 1)
    for every in (2, 7, 42):
        found = carried(motion, 1e-3, 0.042, every)
        for name, poses in found.items():
            np.testing.assert_array_equal(poses, every_step[name][::every])


def test_what_lies_on_a_turning_plate_turns_with_it() -> None:
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        found = carried({"rotation": [[0, 0, 0, 0], [1, 0, 0, 3.0]]}, step, 1.0)
        cube, plate = found["cube"][-1], found["plate"][-1]
        yaw = 2 * math.atan2(plate[5], plate[6])
        assert yaw == pytest.approx(3.0, abs=1e-9)
        assert cube[3:] == pytest.approx(plate[3:], abs=1e-9)
        place = 0.05 * np.array([math.cos(yaw), math.sin(yaw)])
        errors.append(float(np.abs(cube[:2] - place).max()))
    # along the tangent of each step, as the engine moves everything free
    assert errors[-1] < 5e-4
    assert np.array(errors[:-1]) / errors[1:] == pytest.approx([2, 2], rel=0.05)


@pytest.mark.parametrize("step", [5e-4, 2e-3])
def test_what_is_pulled_away_too_fast_slips(step: float) -> None:
    # with 9 m/s at once friction pulls the cube along by μ g until the plate is gone
    path = {"translation": [[0, 0, 0, 0], [1, 9, 0, 0]], "interpolation": "linear"}
    found = carried(path, step, 0.02)
    pulled = found["cube"][-1, 0] - 0.05
    assert pulled == pytest.approx(0.5 * 0.5 * G * 0.02**2, rel=0.15)


def test_it_passes_through_what_is_held_and_needs_no_mass() -> None:
    path = {"translation": [[0, 0, 0, 0], [0.2, 0, 0, -0.5]]}
    found = carried(path, 2e-3, 0.2, position=[0, 0, 0.3])
    assert found["plate"][-1, 2] == pytest.approx(-0.2, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-3, 2e-3, 4e-3])
def test_two_fingers_lift_a_cube_alike_at_every_step(step: float) -> None:
    plan = make_plan(scene_from_file("lift_scene.yaml", f"time_step={step}"))
    names = columns.header(plan.recorded)
    table = dict(zip(names, np.array(rows_of(plan, round(2 / step))).T, strict=True))
    assert table["left.base_pose.z_m"][-1] == pytest.approx(0.185, abs=1e-12)
    held = table["time_s"] > 0.65  # before, the fingers slide up along the cube and take it along
    low = table["cube.pose.z_m"] - table["left.base_pose.z_m"]
    assert np.ptp(low[held]) < 2e-4
    assert table["cube.pose.z_m"][-1] - 0.02 > 0.05
    for part in ("x_m", "y_m", "qx", "qy", "qz"):
        assert np.abs(table[f"cube.pose.{part}"]).max() < 1e-4
    at_rest = table["cube.pose.z_m"][table["time_s"] > 1.6]
    assert np.ptp(at_rest) < 1e-6
    # each finger bears half of it by friction; above what pressing alone would need
    assert table["left.contact.normal_n"][-1] == pytest.approx(0.2096, rel=5e-3)
    assert table["left.contact.normal_n"][-1] > 0.5 * 0.01 * G


@pytest.mark.slow
def test_what_a_hand_holds_turns_with_the_hand() -> None:
    turn = "rotation=[[1.3, 0, 0, 0], [2.0, 0, 0, 1.2]]"
    sets = []
    for number in (0, 1):
        sets += [f"manipulators[{number}].motion.{turn}"]
        sets += [f"manipulators[{number}].motion.about=[0.05, 0, 0]"]
    plan = make_plan(scene_from_file("lift_scene.yaml", *sets))
    names = columns.header(plan.recorded)
    table = dict(zip(names, np.array(rows_of(plan, 2600)).T, strict=True))
    pose = [table[f"cube.pose.{part}"][-1] for part in PARTS]
    start = [table[f"cube.pose.{part}"][table["time_s"] >= 1.3][0] for part in PARTS]
    hand = rotation_from_rpy((0.0, 0.0, 1.2))
    expected = np.add(rotate(hand, (start[0] - 0.05, start[1], 0)), (0.05, 0, start[2]))
    # the fingers, hardly damped, swing by a few millimetres once they are there
    assert np.abs(np.subtract(pose[:3], expected)).max() < 4e-3
    turned = rotation_from_quaternion((pose[3], pose[4], pose[5], pose[6]))
    assert np.abs(np.array(turned) - np.array(hand)).max() < 0.1
