"""The arrays of `dynamics` against the engine, against differences and against each other."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.matrices import stiffness_by_differences
from tests.builders.scenes import scene_from_file

SCENES = ("scene.yaml", "three_axis_finger_scene.yaml", "arm_scene.yaml")
BASE = Pose.of((0.1, 0.2, 0.3), (0.3, -0.4, 1.2))


def plan_of_file(name: str, **changes: object) -> Plan:
    scene = scene_from_file(name)
    one = dataclasses.replace(scene.manipulators[0], **changes)  # type: ignore[arg-type]
    return make_plan(dataclasses.replace(scene, manipulators=(one,)))


def bent_chain(plan: Plan, base: Pose = BASE) -> ChainPose:
    chain = ChainDynamics(plan.bodies[0].chain)
    return chain.at(np.random.default_rng(7).uniform(-0.6, 0.6, chain.count), base)


@pytest.mark.parametrize("name", SCENES)
def test_frames_are_those_of_the_kinematics(name: str) -> None:
    plan = plan_of_file(name)
    pose = bent_chain(plan)
    expected = link_poses(plan.bodies[0].chain, pose.angles.tolist(), BASE)
    assert np.allclose(pose.origins, [one.position for one in expected], atol=1e-14)
    assert np.allclose(pose.rotations, [one.rotation for one in expected], atol=1e-14)
    tip = expected[-1].point(plan.bodies[0].chain.tip)
    assert np.allclose(pose.tip, tip, atol=1e-14)


@pytest.mark.parametrize("base", ["static", "free"])
@pytest.mark.parametrize("name", SCENES)
def test_inertia_and_weight_are_those_of_the_engine(name: str, base: str) -> None:
    rpy = (0.4, -0.2, 1.0)
    plan = plan_of_file(name, base=base, rpy=rpy)
    pose = bent_chain(plan, Pose.of((0.0, 0.0, 0.0), rpy))
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        mass = body.mass_matrix(pose.angles.tolist())
        weight = body.bias(pose.angles.tolist(), [0.0] * len(pose.angles), (0.0, 0.0, 0.0))
    own = pose.joint_inertia(has_free_base=base == "free")
    assert np.abs(own - mass).max() < 1e-13 * np.abs(mass).max()
    joints = weight[-len(pose.angles) :]
    assert (
        np.abs(pose.gravity_force(plan.gravity)[6:] + joints).max() < 1e-13 * np.abs(joints).max()
    )


@pytest.mark.parametrize("name", SCENES)
def test_stiffness_of_gravity_is_the_gradient_of_its_torques(name: str) -> None:
    plan = plan_of_file(name)
    pose = bent_chain(plan)
    exact = pose.gravity_stiffness(plan.gravity)
    found = stiffness_by_differences(
        lambda angles: pose.chain.at(angles, BASE).gravity_force(plan.gravity)[6:], pose.angles
    )
    assert np.abs(found - exact).max() < 1e-8 * np.abs(exact).max()
    assert np.array_equal(exact, exact.T)


@pytest.mark.parametrize("link_from_tip", [0, 2])
def test_stiffness_of_a_force_is_the_gradient_of_its_torques(link_from_tip: int) -> None:
    pose = bent_chain(plan_of_file("three_axis_finger_scene.yaml"))
    link, local = pose.chain.count - link_from_tip, np.array([0.1, 0.2, 0.3])
    force, none = np.array([1.0, 2.0, -0.5]), np.zeros(3)

    def torques(angles: np.ndarray) -> np.ndarray:
        here = pose.chain.at(angles, BASE)
        return here.generalised_force(link, here.point(link, local), force, none)[6:]

    exact = pose.force_stiffness(link, pose.point(link, local), force)
    found = stiffness_by_differences(torques, pose.angles)
    assert np.abs(found - exact).max() < 1e-8 * np.abs(exact).max()


def test_a_force_does_the_work_of_its_generalised_force() -> None:
    pose = bent_chain(plan_of_file("three_axis_finger_scene.yaml"))
    rates = np.random.default_rng(3).normal(size=6 + pose.chain.count)
    linear, angular = pose._jacobians()
    for link in (0, 1, pose.chain.count):
        point = pose.point(link, (0.1, -0.2, 0.3))
        force, moment = np.array([1.0, 2.0, -0.5]), np.array([-0.3, 0.1, 0.7])
        spin = angular[link] @ rates
        velocity = linear[link] @ rates + np.cross(spin, point - pose.centres[link])
        power = force @ velocity + moment @ spin
        assert pose.generalised_force(link, point, force, moment) @ rates == pytest.approx(
            power, rel=1e-12
        )


def test_energies_agree_with_inertia_and_weight() -> None:
    plan = plan_of_file("three_axis_finger_scene.yaml")
    pose = bent_chain(plan)
    rates = np.random.default_rng(3).normal(size=6 + pose.chain.count)
    expected = 0.5 * rates @ pose.mass_matrix() @ rates
    assert pose.kinetic_energy(rates) == pytest.approx(expected, rel=1e-12)
    step = 1e-6 * np.random.default_rng(5).normal(size=pose.chain.count)
    work = pose.gravity_force(plan.gravity)[6:] @ step
    ahead, behind = (pose.chain.at(pose.angles + s * step, BASE) for s in (0.5, -0.5))
    change = ahead.gravity_energy(plan.gravity) - behind.gravity_energy(plan.gravity)
    assert change == pytest.approx(-work, rel=1e-6)
    stretched = ahead.elastic_energy() - behind.elastic_energy()
    springs = pose.chain.stiffness * (pose.angles - pose.chain.neutral)
    assert stretched == pytest.approx(springs @ step, rel=1e-6)
