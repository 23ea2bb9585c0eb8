"""The error that a run reports of itself, against the true one."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from somo_cli.analysis.error_estimate import ErrorEstimate, estimate
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.builders.fingers import struck_finger, struck_finger_in_mujoco
from tests.builders.pendulum import error_of_pendulum, pendulum_scene
from tests.builders.runs import in_turn, rows_of, simulated
from tests.builders.scenes import scene_from_file, scene_from_text


def estimated(scene: Scene, steps: int) -> ErrorEstimate:
    plan = make_plan(scene)
    return estimate(plan, in_turn(rows_of(plan, steps)), steps, BulletWorld, lambda: 0.0)


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
@pytest.mark.parametrize("step", [4e-3, 1e-3])
def test_the_estimate_of_a_hinge_is_its_error(integrator: str, step: float) -> None:
    found = estimated(pendulum_scene(integrator, step), round(1 / step))
    true = error_of_pendulum(integrator, step)
    assert found.order == (2 if integrator == "implicit" else 1)
    assert found.errors[0].maximum == pytest.approx(true, rel=0.15)


@pytest.mark.moderate
@pytest.mark.parametrize("step", [4e-3, 2e-3, 1e-3])
def test_the_estimate_of_a_whipped_finger_is_its_error_within_two(step: float) -> None:
    """Against another simulator, every joint."""
    scene = struck_finger(step)
    steps = round(1 / step)
    true = np.abs(np.array(rows_of(scene, steps))[1:, 1:] - struck_finger_in_mujoco()).max(axis=0)
    reported = np.array([error.maximum for error in estimated(scene, steps).errors])
    assert np.all(reported > true / 2), (reported, true)
    assert np.all(reported < true * 2), (reported, true)


def test_a_final_error_is_that_of_the_last_row() -> None:
    scene = dataclasses.replace(scene_from_file("scene.yaml"), every=100)
    found = estimated(scene, 200)
    short = estimated(dataclasses.replace(scene, every=200), 200)
    assert found.errors[0].final == short.errors[0].final
    assert found.errors[0].maximum >= found.errors[0].final
    assert short.errors[0].rms == pytest.approx(short.errors[0].maximum / np.sqrt(2))


def test_the_sign_of_a_quaternion_is_no_error() -> None:
    scene = scene_from_text(
        "manipulators: [{definition: finger.yaml, base: free, angular_velocity: [0, 0, 20]}]\n"
        "gravity: [0, 0, 0]\nrecord: {every: 5, columns: [base_pose]}\n"
    )
    turns = [error.maximum for error in estimated(scene, 400).errors[3:]]
    assert max(turns) < 0.05


def test_picked_columns_have_the_errors_they_have_among_all() -> None:
    every = {"every": 50, "columns": ["tip_position", "base_pose", "link_orientations"]}
    only = ["*.tip.y_m", "*.base_pose.q[xw]", "*.actuator_1_segment_01.q*"]
    found = []
    for record in (every, {**every, "only": only}):
        scene = scene_from_file("snake_scene.yaml", f"record={json.dumps(record)}")
        names = columns.header(make_plan(scene).recorded)[1:]
        found.append(dict(zip(names, estimated(scene, 200).errors, strict=True)))
    everything, picked = found
    assert len(picked) == 1 + 2 + 4
    for name, error in picked.items():
        assert error == everything[name]


def test_a_run_that_was_stopped_is_compared_with_one_of_the_same_length() -> None:
    scene = scene_from_file("scene.yaml", "stop=[{time: 0.123}]")
    plan = make_plan(scene)
    rows, summary = simulated(plan, 500)
    assert (summary.steps, rows[-1][0]) == (123, 0.123)
    found = estimate(plan, in_turn(rows), summary.steps, BulletWorld, lambda: 0.0)
    last = estimated(dataclasses.replace(scene, stop_conditions=(), every=123), 123)
    assert found.errors[0].final == last.errors[0].final
