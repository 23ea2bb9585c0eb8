"""A simulation stepped by its user: the same trajectory, torques, resets."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

import somo_cli as somo
from somo_cli.loading import load_text
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")

SCENE = DEFINITIONS / "scene.yaml"
# a free finger, a moved object, a free base on the ground, contact with objects
SCENES = ["scene", "push_scene", "crawler_scene", "pinch_scene", "tumble_scene"]
CUTS = [0, 1, 2, 9, 16, 30, 31, 64, 200, 201]  # steps at which pieces of the run end


@pytest.mark.moderate
@pytest.mark.parametrize("name", SCENES)
def test_the_trajectory_is_that_of_a_run_in_whatever_pieces(name: str) -> None:
    document = somo.load(DEFINITIONS / f"{name}.yaml")
    result = somo.simulate(document, CUTS[-1], every=1, record_only=["*.angle_rad"])
    owner = result.names[1].partition(".")[0]
    own = [column for column, one in enumerate(result.names) if one.startswith(f"{owner}.")]
    with somo.Simulation(document) as simulation:
        for _ in range(2):
            for before, after in pairwise(CUTS):
                simulation.step(after - before)
                assert np.array_equal(simulation.angles(owner), result.values[after, own])
            simulation.reset()


def test_objects_move_the_same_step_by_step_and_all_at_once() -> None:
    """A step at a time, checks of sliding and of spin were made where the user paused."""
    document = somo.load(DEFINITIONS / "tumble_scene.yaml")
    with somo.Simulation(document) as single, somo.Simulation(document) as whole:
        for _ in range(200):
            single.step()
        whole.step(200)
        for name in whole.objects:
            found = (*single.object_pose(name), *single.object_velocity(name))
            expected = (*whole.object_pose(name), *whole.object_velocity(name))
            for one, other in zip(found, expected, strict=True):
                assert np.array_equal(one, other)


def test_states_read_are_those_that_a_run_records() -> None:
    result = somo.simulate(
        SCENE,
        100,
        every=100,
        record_only=["finger.tip.*", "*.rate_rad_per_s", "finger.base_pose.*"],
    )
    rates = [column for column, one in enumerate(result.names) if one.endswith("rate_rad_per_s")]
    with somo.Simulation(SCENE) as simulation:
        simulation.step(100)
        assert simulation.time == pytest.approx(0.1)
        tip = [result[f"finger.tip.{axis}_m"][-1] for axis in "xyz"]
        assert simulation.tip_position("finger") == pytest.approx(tip, abs=1e-15)
        assert simulation.rates("finger") == pytest.approx(result.values[-1, rates], rel=1e-3)
        position, turn = simulation.base_pose("finger")
        assert [*position, *turn] == [
            result[f"finger.base_pose.{part}"][-1]
            for part in ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")
        ]


def test_objects_have_a_pose_and_a_contact_force() -> None:
    with somo.Simulation(DEFINITIONS / "tumble_scene.yaml") as simulation:
        names = [one for one in simulation.objects if one == "cube"] or list(simulation.objects)
        first, _ = simulation.object_pose(names[0])
        simulation.step(1500)
        last, turn = simulation.object_pose(names[0])
        assert last[2] < first[2]
        assert np.linalg.norm(turn) == pytest.approx(1)
        assert simulation.contact_force(names[0])[2] > 0
        velocity, spin = simulation.object_velocity(names[0])
        assert velocity.shape == spin.shape == (3,)


JOINTS = "manipulators[0].definition.actuator_definitions[0].joint_definitions"
STIFFNESS = 0.117045  # N·m/rad, of the joints about x
DAMPED = [f"{JOINTS}[{joint}].spring_damping=0.02" for joint in (0, 1)]
ABOUT_X = slice(0, None, 2)


def test_a_torque_bends_every_joint_of_its_axis_until_the_spring_holds_it() -> None:
    with somo.Simulation(somo.load(SCENE, sets=["gravity=[0, 0, 0]", *DAMPED])) as simulation:
        simulation.set_torque("finger", actuator=0, axis=1, torque=0.0)
        for torque in (0.01, -0.02, 0.0):
            simulation.set_torque("finger", actuator=0, axis=0, torque=torque)
            simulation.step(6000)
            angles = simulation.angles("finger")
            assert angles[ABOUT_X] == pytest.approx([torque / STIFFNESS] * 5, abs=1e-6)


def test_feedback_holds_an_angle_that_the_scene_does_not_ask_for() -> None:
    with somo.Simulation(somo.load(SCENE, sets=DAMPED)) as simulation:
        torque = 0.0
        for _ in range(600):
            error = 0.4 - float(simulation.angles("finger")[ABOUT_X].sum())
            torque += 0.05 * STIFFNESS / 5 * error
            simulation.set_torque("finger", actuator=0, axis=0, torque=torque)
            simulation.step(10)
        assert simulation.angles("finger")[ABOUT_X].sum() == pytest.approx(0.4, abs=1e-3)


def test_two_simulations_do_not_disturb_each_other() -> None:
    with somo.Simulation(SCENE) as one, somo.Simulation(SCENE, time_step=5e-4) as other:
        for _ in range(20):
            one.step(5)
            other.step(3)
        alone = somo.Simulation(SCENE)
        alone.step(100)
        assert np.array_equal(alone.angles("finger"), one.angles("finger"))
        alone.close()


def test_what_engines_share_is_each_one_s_own() -> None:
    """Where something rebounds, bodies collide at another distance, which engines share."""
    ball = {
        "name": "ball",
        "shape_type": "sphere",
        "dimensions": [0.02],
        "mass": 0.05,
        "position": [0.3, 0, 0.1],
        "restitution": 0.8,
    }
    scene = {
        "manipulators": [{"definition": "finger.yaml", "position": [0, 0, 0.5]}],
        "ground": {"restitution": 0.8},
        "objects": [ball],
    }
    bouncing = load_text(json.dumps(scene), str(DEFINITIONS / "test.json"))
    with somo.Simulation(bouncing) as alone:
        alone.step(400)
        expected, _ = alone.object_pose("ball")
    with somo.Simulation(bouncing) as one, somo.Simulation(DEFINITIONS / "pinch_scene.yaml") as two:
        for _ in range(40):
            one.step(10)
            two.step(1)
        found, _ = one.object_pose("ball")
    assert np.array_equal(found, expected)


def test_standard_output_stays_the_user_s(environment: dict[str, str]) -> None:
    script = (
        "import os, sys, somo_cli\n"
        "with somo_cli.Simulation(sys.argv[1]) as simulation:\n"
        "    simulation.step(1)\n"
        "    os.write(1, b'mine')\n"
    )
    command = [sys.executable, "-c", script, str(SCENE)]
    ended = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert ended.stdout == "mine"


@pytest.mark.slow
def test_a_thousand_resets_give_the_same_and_take_no_memory() -> None:
    with somo.Simulation(SCENE) as simulation:
        simulation.step(20)
        first, before = simulation.angles("finger"), 0
        for count in range(1000):
            simulation.reset()
            simulation.step(20)
            assert np.array_equal(simulation.angles("finger"), first)
            if count == 100:
                before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 4000  # KiB


def test_wrong_names_and_numbers_are_refused() -> None:
    with somo.Simulation(SCENE) as simulation:
        with pytest.raises(KeyError, match="the names are finger"):
            simulation.angles("thumb")
        with pytest.raises(ValueError, match="no joints of actuator 7 about axis 0"):
            simulation.set_torque("finger", actuator=7, axis=0, torque=0.1)
        with pytest.raises(ValueError, match="must be a finite number"):
            simulation.set_torque("finger", actuator=0, axis=0, torque=float("nan"))
        with pytest.raises(ValueError, match="must not be negative"):
            simulation.step(-1)
    with pytest.raises(RuntimeError, match="closed"):
        simulation.step()


def test_divergence_is_raised_within_a_few_steps() -> None:
    document = somo.load(SCENE, sets=["integrator=explicit", "time_step=0.02"])
    with somo.Simulation(document) as simulation, pytest.raises(somo.SimulationDiverged):
        simulation.step(500)
