"""Manipulators whose base is free keep energy and momentum however fast they spin."""

from __future__ import annotations

import dataclasses
import functools
import json
from typing import cast

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Dimension
from somo_cli.manipulator.geometry import Vector
from somo_cli.problems import SimulationDiverged
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.engine.interface import WorldFreeBody
from somo_cli.simulation.integrator import spinning_base
from somo_cli.simulation.integrator.spinning_base import SpinningBase, spin_to_follow
from somo_cli.simulation.plan_report import explain
from somo_cli.simulation.session import Session
from tests.builders.fingers import free_states_in_mujoco
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text
from tests.free_bodies.chains import AXES, CHAINS, SOFT, STIFF, chain_motion, chain_plan, spin_of


@pytest.mark.moderate
@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("name", CHAINS)
def test_energy_and_momentum_are_kept_at_a_tenth_of_a_radian_in_a_step(
    name: str, axis: Vector
) -> None:
    plan = chain_plan(CHAINS[name], spin_of(axis, 100.0), 1e-3)
    motion = chain_motion(plan, 4.0)
    assert motion.swing() < 4e-3
    assert abs(motion.drift()) < 2e-4
    assert motion.momentum_error() < 2e-3


@pytest.mark.moderate
@pytest.mark.parametrize(("size", "swing"), [(300.0, 0.03), (1000.0, 0.25)])
def test_a_stiff_chain_never_gains_up_to_a_radian_in_a_step(size: float, swing: float) -> None:
    motion = chain_motion(chain_plan(STIFF, spin_of(AXES[0], size), 1e-3), 4.0)
    assert motion.swing() < swing
    assert abs(motion.drift()) < 0.05 * swing
    assert motion.momentum_error() < 0.2 * swing


def test_without_it_the_same_chain_gains_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spinning_base, "spin_to_follow", lambda time_step: np.inf)
    motion = chain_motion(chain_plan(STIFF, spin_of(AXES[0], 300.0), 1e-3), 1.0)
    assert motion.drift() > 5e-3


def test_the_heading_and_the_world_scale_change_nothing() -> None:
    swings = []
    for more in ({}, {"world_scale": {"length": 20, "mass": 0.1}}):
        plan = chain_plan(SOFT, spin_of(AXES[0], 60.0), 1e-3, **more)
        motion = chain_motion(plan, 0.3)
        swings.append((motion.energies / motion.energies[0], motion.momenta / motion.momenta[0]))
    assert swings[1][0] == pytest.approx(swings[0][0], abs=1e-9)
    assert swings[1][1] == pytest.approx(swings[0][1], abs=1e-7)


MOMENTUM = Dimension(mass=1, length=2, time=-1)

THROWN = json.dumps(
    {
        "manipulators": [
            {
                "definition": "finger.yaml",
                "base": "free",
                "rpy": [0.3, -0.4, 1.2],
                "linear_velocity": [0.1, -0.2, 0.3],
                "angular_velocity": [20.0, 40.0, -30.0],
                "actuation": [{"actuator": 0, "axis": 0, "torque": 0.03}],
            }
        ],
        "record": {"columns": ["joint_angles", "base_pose"]},
    }
)


def thrown(step: float) -> Scene:
    """Return a finger with a free base that spins at 54 rad/s, bent by torques, under gravity."""
    joints = "manipulators[0].definition.actuator_definitions[0].joint_definitions"
    scene = scene_from_text(
        THROWN,
        "manipulators[0].definition.base_definition.mass=0.03",
        f"{joints}[0].spring_damping=0.001",
        f"{joints}[1].spring_damping=0.003",
    )
    return dataclasses.replace(scene, time_step=step, every=round(0.1 / step))


@functools.cache
def thrown_in_mujoco() -> np.ndarray:
    """Return angles [rad], position [m] and rotation of the base every tenth of a second."""
    states = free_states_in_mujoco(thrown(1e-3), 2e-5, 4)
    turns = [_rotation(one) for one in states[:, [4, 5, 6, 3]]]
    return np.hstack([states[:, 7:], states[:, :3], turns])


def _rotation(quaternion: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternion.tolist()
    return np.array(geometry.rotation_from_quaternion((x, y, z, w))).ravel()


@pytest.mark.moderate
def test_a_spinning_finger_moves_as_in_another_simulator_to_second_order() -> None:
    truth, errors = thrown_in_mujoco(), []
    for step in (2e-3, 1e-3):
        rows = np.array(rows_of(thrown(step), round(0.4 / step)))[1:, 1:18]
        turned = np.array([_rotation(row) for row in rows[:, 13:]])
        away = np.abs(np.hstack([rows[:, :13], turned]) - truth)
        errors.append((away[:, :10].max(), away[:, 10:13].max(), away[:, 13:].max()))
    angle, place, turn = errors[1]
    assert angle < 2e-3
    assert place < 1e-4
    assert turn < 0.04
    assert np.log2(np.divide(*errors)) == pytest.approx(2, abs=0.2), errors


@pytest.mark.parametrize("link", ["base", "tip"])
def test_the_momentum_of_a_spinning_chain_grows_by_the_moment_of_a_load(link: str) -> None:
    moment = np.array([0.002, -0.003, 0.005])
    load = {"link": link, "moment": moment.tolist()}
    plan = chain_plan(SOFT, spin_of(AXES[0], 60.0), 1e-3, loads=[load])
    momenta = chain_motion(plan, 0.5, every=1).momenta / plan.scale.factor(MOMENTUM)
    grown = momenta - momenta[0] - np.arange(len(momenta))[:, np.newaxis] * 1e-3 * moment
    assert np.abs(grown).max() < 4e-3 * np.linalg.norm(momenta[0])
    assert np.linalg.norm(momenta[-1] - momenta[0]) > 0.05 * np.linalg.norm(momenta[0])


def test_only_what_spins_is_followed() -> None:
    threshold = spin_to_follow(1e-3)
    assert threshold == pytest.approx(21.1, abs=0.1)
    for size, is_followed in ((0.9 * threshold, False), (1.1 * threshold, True)):
        plan = chain_plan(STIFF, spin_of(AXES[0], size), 1e-3)
        with BulletWorld(plan) as world:
            session = Session(plan, world)
            session.actuate()
            session.advance(8)
            (stepper,) = session.steppers
            assert stepper.base.needs_fresh_inertia() is is_followed


def test_a_base_that_its_joints_turn_to_and_fro_is_not_followed() -> None:
    """Links turn about the hinges against each other, so the whole does not spin."""
    rates = np.array([100.0, -30.0])  # rad/s of the hinges
    plan = chain_plan(STIFF, (0.0, 0.0, 0.0), 1e-3)
    with BulletWorld(plan) as world:
        (body,) = world.bodies
        body.mass_matrix([0.0, 0.0])
        followed = SpinningBase(body, 1e-3, plan.gravity)
        _, base_to_joints = cast(WorldFreeBody, body).base_response()
        spin = -rates @ base_to_joints[:, :3]
        assert np.linalg.norm(spin) > 2 * spin_to_follow(1e-3)
        assert not followed.is_needed(spin, rates)
        assert followed.is_needed(spin, np.zeros(2))


def test_where_no_rounds_converge_extrapolation_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = chain_plan(SOFT, spin_of(AXES[0], 60.0), 1e-3)
    monkeypatch.setattr(spinning_base, "fixed_point", lambda *arguments: None)
    unsolved = chain_motion(plan, 0.2)
    monkeypatch.setattr(spinning_base, "spin_to_follow", lambda time_step: np.inf)
    extrapolated = chain_motion(plan, 0.2)
    assert unsolved.energies == pytest.approx(extrapolated.energies, rel=1e-3)
    assert unsolved.swing() > 1e-4


def test_the_plan_says_what_is_followed() -> None:
    plan = chain_plan(STIFF, (1.0, 2.0, 3.0), 1e-3)
    (said,) = (one for one in explain(plan) if "momentum" in one.what)
    assert said.is_kept
    assert said.why.startswith("of chain, above 21 rad/s")
    plan = chain_plan(STIFF, (1.0, 2.0, 3.0), 1e-5, integrator="explicit")
    (said,) = (one for one in explain(plan) if "momentum" in one.what)
    assert not said.is_kept


def test_a_base_that_turns_too_far_in_a_step_ends_the_run() -> None:
    plan = chain_plan(STIFF, (0.0, 0.0, 2000.0), 1e-3)
    with pytest.raises(
        SimulationDiverged, match=r"manipulator 'chain': its base turns 1.9. rad in"
    ):
        chain_motion(plan, 0.1)


@pytest.mark.moderate
def test_a_spinning_chain_that_falls_loses_energy_and_comes_to_rest() -> None:
    ground = {"height": -0.4, "friction": 0.5}
    scene: dict[str, object] = {"gravity": [0, 0, -9.81], "ground": ground}
    definition = json.loads(json.dumps(STIFF))
    definition["actuator_definitions"][0]["joint_definitions"][0]["spring_damping"] = 0.05
    for integrator in ("implicit", "euler"):
        plan = chain_plan(definition, spin_of(AXES[0], 60.0), 1e-3, **scene, integrator=integrator)
        with BulletWorld(plan) as world:
            session = Session(plan, world)
            fastest = []
            for step in range(2500):
                session.monitor()
                session.actuate()
                session.advance(step + 1)
                velocity, spin = world.bodies[0].base_velocity()
                fastest.append(np.linalg.norm([*velocity, *spin]))
        assert max(fastest) < 150
        assert fastest[-1] < 0.05
