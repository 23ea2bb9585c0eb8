"""A base that is moved: where it is, and what its joints feel, against theory and MuJoCo."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import numpy as np
import pytest
import scipy.optimize

from somo_cli.manipulator import geometry
from somo_cli.problems import EngineRefused
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import Y, actuator, hinge, manipulator
from tests.builders.runs import columns_of, rows_of
from tests.builders.scenes import scene_from_text

pytest.importorskip("pybullet")

SHAKE = [[0, 0, 0, 0], [0.1, 0.05, 0, 0], [0.2, 0, 0.03, 0.02], [0.4, 0.02, 0, 0]]
TURN = [[0, 0, 0, 0], [0.25, 1.0, 0.5, 0.3], [0.5, 2.0, -0.5, 1.0]]
ABOUT = [0.05, -0.02, 0.1]
MOTIONS: dict[str, dict[str, Any]] = {
    "shaken": {"translation": SHAKE},
    "turned": {"rotation": TURN},
    "both": {"translation": SHAKE, "rotation": TURN, "about": ABOUT},
}


def finger(motion: dict[str, Any], step: float, integrator: str = "implicit") -> Scene:
    one = {"definition": "finger.yaml", "base": "constrained", "motion": motion}
    data = {
        "time_step": step,
        "integrator": integrator,
        "manipulators": [one],
        "record": {"every": round(0.02 / step), "columns": ["joint_angles", "base_pose", "energy"]},
    }
    return scene_from_text(json.dumps(data))


def columns_until(scene: Scene, time: float) -> dict[str, np.ndarray]:
    return columns_of(scene, round(time / scene.time_step))


def angles_in(found: dict[str, np.ndarray]) -> np.ndarray:
    return np.transpose([values for name, values in found.items() if name.endswith(".angle_rad")])


@pytest.mark.parametrize("step", [1e-3, 4e-3])
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_the_base_is_where_its_path_says(step: float, interpolation: str) -> None:
    scene = finger({**MOTIONS["both"], "interpolation": interpolation}, step)
    (body,) = make_plan(scene).bodies
    found = columns_until(scene, 0.6)
    assert body.path is not None
    for index, time in enumerate(found["time_s"]):
        pose = body.path.at(float(time))
        place = [found[f"finger.base_pose.{part}"][index] for part in ("x_m", "y_m", "z_m")]
        turn = np.array(
            [found[f"finger.base_pose.{part}"][index] for part in ("qx", "qy", "qz", "qw")]
        )
        assert place == pytest.approx(np.array(pose.position) / 20, abs=1e-12)
        expected = np.array(geometry.quaternion_from_rotation(pose.rotation))
        assert turn * np.sign(np.dot(turn, expected)) == pytest.approx(expected, abs=1e-12)


@pytest.mark.moderate
@pytest.mark.parametrize("name", MOTIONS)
def test_the_joints_feel_it_as_in_mujoco(name: str) -> None:
    pytest.importorskip("mujoco")
    from tests.builders.mujoco_reference import mujoco_model, mujoco_trajectory_on_prescribed_base

    (one,) = finger(MOTIONS[name], 1e-3).manipulators
    assert one.motion is not None
    motion = one.motion
    if motion.about is not None:
        # MuJoCo's joints turn about the base; a path about another point is no sum of such
        motion = type(motion)(motion.translation, motion.rotation, None, "cubic", False)
        data = {**MOTIONS[name]}
        del data["about"]
    else:
        data = MOTIONS[name]
    model = mujoco_model(one.compiled.chain, (0, 0, -9.81), 2.5e-4, has_prescribed_base=True)
    times = np.arange(0, 0.51, 0.02).tolist()
    reference = mujoco_trajectory_on_prescribed_base(model, motion, times)
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        found = angles_in(columns_until(finger(data, step), 0.5))
        errors.append(float(np.abs(found - reference[: len(found)]).max()))
    assert np.abs(reference).max() > 0.3
    assert errors[1] < 2e-4
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.85, errors


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_who_moves_steadily_feels_nothing(integrator: str) -> None:
    shift = {"translation": [[0, 0, 0, 0], [1, 0.3, 0.4, 0]], "interpolation": "linear"}
    moved = columns_until(finger(shift, 1e-3, integrator), 0.5)
    still = columns_until(finger({"translation": [[0, 0, 0, 0]]}, 1e-3, integrator), 0.5)
    # to what it costs to hold the Coriolis correction while a body at rest moves slowly
    assert angles_in(moved) == pytest.approx(angles_in(still), abs=2e-6)
    mass = 0.6 + 10 * 0.00294 + 0.015
    kinetic = moved["finger.energy.kinetic_j"]
    assert kinetic[0] == pytest.approx(0.5 * mass * 0.5**2, rel=1e-6)


def test_a_prescribed_base_at_rest_is_a_fixed_base() -> None:
    data = {"definition": "finger.yaml", "base": "constrained", "rpy": [0.5, 0, 0]}
    record = {"columns": ["joint_angles", "tip_position"]}
    rows = []
    for one in (data, {**data, "motion": {"translation": [[0, 0, 0, 0]]}}):
        scene = scene_from_text(json.dumps({"manipulators": [one], "record": record}))
        rows.append(rows_of(scene, 200))
    assert np.array(rows[1]) == pytest.approx(np.array(rows[0]), abs=1e-5)


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
@pytest.mark.parametrize("end", [0.016, 0.0173, 0.021])
def test_where_rows_fall_changes_nothing_when_the_base_comes_to_rest(
    integrator: str, end: float
) -> None:
    step = 1e-4 if integrator == "explicit" else 1e-3
    motion = {"translation": [[0, 0, 0, 0], [end, 0.002, 0, 0]], "interpolation": "linear"}
    scene = finger(motion, step, integrator)

    def rows(every: int) -> list[list[float]]:
        return rows_of(dataclasses.replace(scene, every=every), round(0.042 / step))

    every_step = rows(1)
    for every in (2, 7, round(0.042 / step)):
        assert rows(every) == every_step[::every]


@pytest.mark.moderate
def test_a_carousel_bends_a_hinge_as_far_as_theory_says() -> None:
    radius, spin = 0.2, 4.0
    swing = hinge(0, 1, 0, spring_stiffness=1e-3, spring_damping=1e-4)
    one = {
        "definition": manipulator(actuator(1, swing), world_scale=20),
        "base": "constrained",
        "position": [radius, 0, 0],
        "motion": {
            "rotation": [[0, 0, 0, 0], [9, 0, 0, 9 * spin]],
            "about": [0, 0, 0],
            "interpolation": "linear",
        },
    }
    data = {"manipulators": [one], "gravity": [0, 0, 0], "record": {"every": 2000}}
    scene = scene_from_text(json.dumps(data))
    chain = scene.manipulators[0].compiled.chain
    (joint,), link = chain.joints, chain.links[1]
    arm = link.inertial.centre[2]
    xx, _, _, _, _, zz = link.inertial.inertia

    def torque(angle: float) -> float:
        # of m ω² r at the centre of mass, and of the products of inertia of the tilted link
        out = radius + arm * math.sin(angle)
        pull = link.inertial.mass * spin**2 * out * arm * math.cos(angle)
        pull += (xx - zz) * spin**2 * math.sin(angle) * math.cos(angle)
        return pull - joint.stiffness * angle

    expected = scipy.optimize.brentq(torque, 0.0, 1.0)
    found = rows_of(scene, 8000)[-1][1]
    assert expected > 0.005
    assert found == pytest.approx(expected, rel=1e-5)


def test_what_turns_too_far_in_a_step_is_refused() -> None:
    fast = {"rotation": [[0, 0, 0, 0], [0.1, 50, 0, 0]]}
    with pytest.raises(EngineRefused, match=r"turns the base by .* rad in the step at"):
        rows_of(finger(fast, 4e-3), 25)


def test_limits_and_dry_friction_in_a_shaken_frame() -> None:
    stop = hinge(1, 0, 0, limits=[-0.05, 0.05, 10, 20], spring_stiffness=0.02)
    stuck = {**Y, "joint_control_limit_force": 0.05}
    shake = [[0.05 * n, 0, 0.03 * (n % 2), 0.01 * (n % 3)] for n in range(20)]
    one = {
        "definition": manipulator(
            actuator(2, stop), actuator(2, stuck, planar_flag=1), world_scale=20
        ),
        "base": "constrained",
        "motion": {"translation": shake},
    }
    scene = scene_from_text(json.dumps({"manipulators": [one], "record": {"every": 10}}))
    found = angles_in(columns_until(scene, 1.0))
    limited, held = found[:, 0], found[:, -1]
    assert np.abs(limited).max() == pytest.approx(0.05, abs=1e-3)
    assert np.abs(held).max() < 1e-3


def test_a_base_goes_on_against_what_its_links_meet() -> None:
    # the base itself strikes a block of 10 kg, with two thousand newtons
    block = {"name": "block", "shape_type": "box", "dimensions": [0.1, 0.05, 0.2], "mass": 10}
    shift = {"translation": [[0, 0, 0, 0], [0.3, 0, 0.1, 0]]}
    one = {"definition": "finger.yaml", "base": "constrained", "position": [0, 0, 0.01]}
    data = {
        "ground": {},
        "manipulators": [{**one, "motion": shift}],
        "objects": [{**block, "position": [0, 0.06, 0], "place": {"on": "ground"}}],
        "record": {"columns": ["base_pose", "contact_force"]},
    }
    scene = scene_from_text(json.dumps(data))
    found = columns_until(scene, 0.4)
    path = make_plan(scene).bodies[0].path
    assert path is not None
    expected = np.array([path.at(float(time)).position for time in found["time_s"]]) / 20
    pose = np.transpose([found[f"finger.base_pose.{part}"] for part in ("x_m", "y_m", "z_m")])
    assert found["finger.contact.normal_n"].max() > 500
    assert np.abs(pose - expected).max() < 1e-7
