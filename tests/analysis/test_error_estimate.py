"""The error that a run reports of itself, against the true one."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.fingers import struck_finger, struck_finger_in_mujoco
from tests.builders.pendulum import error_of_pendulum, pendulum_scene
from tests.builders.runs import estimated_errors, rows_of, simulated
from tests.builders.scenes import scene_from_file, scene_from_text


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
@pytest.mark.parametrize("step", [4e-3, 1e-3])
def test_the_estimate_of_a_hinge_is_its_error(integrator: str, step: float) -> None:
    found = estimated_errors(pendulum_scene(integrator, step), round(1 / step))
    true = error_of_pendulum(integrator, step)
    assert found.order == (2 if integrator == "implicit" else 1)
    assert found.errors[0].order.value == pytest.approx(found.order, abs=0.3)
    assert found.errors[0].maximum == pytest.approx(true, rel=0.15)


@pytest.mark.moderate
@pytest.mark.parametrize("step", [4e-3, 2e-3, 1e-3])
def test_the_estimate_of_a_whipped_finger_is_its_error_within_two(step: float) -> None:
    """Against another simulator, every joint."""
    scene = struck_finger(step)
    steps = round(1 / step)
    true = np.abs(np.array(rows_of(scene, steps))[1:, 1:] - struck_finger_in_mujoco()).max(axis=0)
    reported = np.array([error.maximum for error in estimated_errors(scene, steps).errors])
    assert np.all(reported > true / 2), (reported, true)
    assert np.all(reported < true * 2), (reported, true)


def test_a_final_error_is_that_of_the_last_row() -> None:
    scene = dataclasses.replace(scene_from_file("scene.yaml"), every=100)
    found = estimated_errors(scene, 200)
    short = estimated_errors(dataclasses.replace(scene, every=200), 200)
    first, last = found.errors[0], short.errors[0]
    finer = dataclasses.replace(scene, time_step=scene.time_step / 2, every=400)
    difference = abs(rows_of(scene, 200)[-1][1] - rows_of(finer, 400)[-1][1])
    for one in (first, last):
        assert one.final == pytest.approx(one.order.share_of_run * difference)
    assert first.maximum >= first.final
    assert last.rms == pytest.approx(last.maximum / np.sqrt(2))


def test_the_sign_of_a_quaternion_is_no_error() -> None:
    scene = scene_from_text(
        "manipulators: [{definition: finger.yaml, base: free, angular_velocity: [0, 0, 20]}]\n"
        "gravity: [0, 0, 0]\nrecord: {every: 5, columns: [base_pose]}\n"
    )
    turns = [error.maximum for error in estimated_errors(scene, 400).errors[3:]]
    assert max(turns) < 0.05


def test_picked_columns_have_the_errors_they_have_among_all() -> None:
    every = {"every": 50, "columns": ["tip_position", "base_pose", "link_orientations"]}
    only = ["*.tip.y_m", "*.base_pose.q[xw]", "*.actuator_1_segment_01.q*"]
    found = []
    for record in (every, {**every, "only": only}):
        scene = scene_from_file("snake_scene.yaml", f"record={json.dumps(record)}")
        names = columns.header(make_plan(scene).recorded)[1:]
        found.append(dict(zip(names, estimated_errors(scene, 200).errors, strict=True)))
    everything, picked = found
    assert len(picked) == 1 + 2 + 4
    for name, error in picked.items():
        # the order is seen in other columns as well
        other = everything[name]
        factor = other.order.share_of_run / error.order.share_of_run
        assert factor * error.maximum == pytest.approx(other.maximum, rel=1e-12)
        assert factor * error.final == pytest.approx(other.final, rel=1e-12)


def test_a_run_that_was_stopped_is_compared_with_one_of_the_same_length() -> None:
    scene = scene_from_file("scene.yaml", "stop=[{time: 0.123}]")
    plan = make_plan(scene)
    rows, summary = simulated(plan, 500)
    assert (summary.steps, rows[-1][0]) == (123, 0.123)
    found = estimated_errors(plan, 500)
    last = estimated_errors(dataclasses.replace(scene, stop_conditions=(), every=123), 123)
    ends = [one.errors[0].final / one.errors[0].order.share_of_run for one in (found, last)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


@pytest.mark.moderate
def test_joints_that_strike_their_limits_are_told_their_error_within_two_on_the_whole() -> None:
    """The time of a strike is off by up to a step, so errors scatter, but they fall with order 1.

    The order of the integrator, which is 2, would tell less.
    """
    joints = "manipulators[0].definition.actuator_definitions[0].joint_definitions"
    scene = scene_from_text(
        "manipulators:\n  - definition: finger.yaml\n    actuation:\n"
        "      - {actuator: 0, axis: 0, torque: 0.1}\n",
        f"{joints}[0].limits=[-0.2,0.2,1,9]",
    )
    fine = np.array(rows_of(dataclasses.replace(scene, time_step=4e-5, every=500), 5_000))
    ratios = []
    for step in (4e-3, 2e-3, 1e-3, 5e-4):
        coarse = dataclasses.replace(scene, time_step=step, every=round(0.02 / step))
        steps = round(0.2 / step)
        true = np.abs(np.array(rows_of(coarse, steps)) - fine)[:, 1:].max()
        told = max(one.maximum for one in estimated_errors(coarse, steps).errors)
        ratios.append(told / true)
    assert 1 / 2 < np.exp(np.mean(np.log(ratios))) < 2, ratios
    assert 1 / 5 < min(ratios) < max(ratios) < 2, ratios


def test_where_twice_the_step_diverges_a_quarter_tells_the_order() -> None:
    scene = scene_from_file("scene.yaml", "integrator=explicit", "time_step=3e-4")
    found = estimated_errors(dataclasses.replace(scene, every=50), 1000)
    assert found.others == (1.5e-4, 7.5e-5)
    fine = dataclasses.replace(scene, time_step=3e-5, every=500)
    true = np.abs(
        np.array(rows_of(dataclasses.replace(scene, every=50), 1000))
        - np.array(rows_of(fine, 10_000))
    )[:, 1:].max(axis=0)
    told = np.array([one.maximum for one in found.errors])
    assert told.max() == pytest.approx(true.max() / 0.9, rel=0.2)  # the truth is off by a tenth


@pytest.mark.parametrize("every", [1, 2, 3, 10])
def test_rows_at_any_distance_are_compared_at_the_same_instants(every: int) -> None:
    """Of an odd number of steps every second row is one of a run at twice the step."""
    scene = dataclasses.replace(scene_from_file("gauss_finger_scene.yaml"), every=every)
    found = estimated_errors(scene, 203)
    assert found.others == (2e-3, 5e-4)
    tip = found.errors[-1]
    assert tip.order.value == pytest.approx(2.0, abs=0.2)
