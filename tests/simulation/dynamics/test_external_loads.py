"""External loads: as generalised forces, at rest against exact equilibria, in motion on a hinge."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.model import ExternalLoad, Frame, Scene
from somo_cli.scene.signals import piecewise_signal
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.external_loads import ExternalLoads
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import PlannedLoad
from tests.builders.definitions import actuator, chain_of, hinge, manipulator
from tests.builders.pendulum import PENDULUM_INERTIA, pendulum_angle, pendulum_scene
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text
from tests.builders.shipped import shipped_chain

BASE = Pose.of((0.1, 0.2, 0.3), (0.3, -0.4, 1.2))
ANGLES = np.linspace(-0.3, 0.4, 10)


def cantilever(*loads: dict[str, Any], **changes: Any) -> Scene:
    """Return the shipped cantilever, ten joints of 10 N·m/rad on 1 m, under these loads."""
    scene = scene_from_file("cantilever_scene.yaml", f"manipulators[0].loads={json.dumps(loads)}")
    return dataclasses.replace(scene, columns=("joint_angles",), **changes)


def acting(*loads: dict[str, Any]) -> ExternalLoads:
    """Return loads on a cantilever whose base may be anywhere, and is at BASE."""
    scene = cantilever(*loads)
    one = dataclasses.replace(scene.manipulators[0], base="free")
    (body,) = make_plan(dataclasses.replace(scene, manipulators=(one,))).bodies
    return ExternalLoads(body, lambda: BASE)


def test_a_load_is_the_force_of_its_link_at_its_point() -> None:
    chain = ChainDynamics(cantilever().manipulators[0].compiled.chain)
    pose = chain.at(ANGLES, BASE)
    axes = pose.rotations[4]
    world = {"force": [1, 2, 3], "moment": [4, 5, 6], "point": [0.1, 0.2, 0.3]}
    body = {**world, "link": "actuator_0_segment_04", "frame": "body"}
    force, moment = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    at_tip = pose.point(10, chain.tip + np.array([0.1, 0.2, 0.3]))
    expected = pose.generalised_force(10, at_tip, force, moment)
    assert acting(world).force(0, ANGLES) == pytest.approx(expected, abs=1e-14)
    turned = pose.generalised_force(4, pose.point(4, [0.1, 0.2, 0.3]), axes @ force, axes @ moment)
    assert acting(body).force(0, ANGLES) == pytest.approx(turned, abs=1e-14)
    both = acting(world, body).force(0, ANGLES)
    assert both == pytest.approx(expected + turned, abs=1e-14)


def test_a_load_follows_its_waypoints() -> None:
    points = {"waypoints": [[1, 0], [3, 2], [4, 0]]}
    ramp = acting({"force": [1, 0, 0], **points})
    whole = acting({"force": [1, 0, 0]}).force(0, ANGLES)
    for time, factor in ((0, 0), (1, 0), (1.5, 0.5), (3 - 1e-9, 2 - 1e-9), (3.5, 1), (9, 0)):
        assert ramp.force(time, ANGLES) == pytest.approx(factor * whole, abs=1e-12)
    steps = acting({"force": [1, 0, 0], **points, "interpolation": "step"})
    for time, factor in ((0.5, 0), (2.9, 0), (3, 2), (3.9, 2), (4, 0)):
        assert np.array_equal(steps.force(time, ANGLES), factor * whole)


def test_only_what_does_not_act_is_steady() -> None:
    """A constant load is not: its torques change with the pose."""
    late = {"force": [1, 0, 0], "waypoints": [[1, 0], [2, 1], [3, 0]]}
    loads = acting(late, {**late, "waypoints": [[1.5, 0], [2, 1], [2.5, 0]]})
    assert [loads.constant_until(time) for time in (0, 1.2, 2.7, 3)] == [1, 1.2, 2.7, math.inf]
    assert acting({"force": [1, 0, 0]}).constant_until(7) == 7


def test_work_is_force_times_displacement_and_moment_times_angle() -> None:
    chain = ChainDynamics(cantilever().manipulators[0].compiled.chain)
    loads = acting({"force": [1, 2, 3]}, {"moment": [4, 5, 6], "frame": "body"})
    # along the straight line from zero, by Gauss and Legendre
    points, weights = np.polynomial.legendre.leggauss(20)
    powers = [loads.force(0, 0.5 * (1 + point) * ANGLES)[6:].dot(ANGLES) for point in points]
    path = chain.at(ANGLES, BASE).tip - chain.at(np.zeros(10), BASE).tip
    # the last link turns by the sum of the angles about the y axis that all joints share
    exact = path @ [1, 2, 3] + 5 * ANGLES.sum()
    assert 0.5 * weights.dot(powers) == pytest.approx(exact, rel=1e-12)


def equilibrium(chain: Chain, force: np.ndarray) -> np.ndarray:
    """Return the angles at which K (q - q0) = J'F for a dead force at the tip (Newton)."""
    dynamics = ChainDynamics(chain)
    springs = np.diag(dynamics.stiffness)
    angles = dynamics.neutral
    for _ in range(30):
        pose = dynamics.at(angles)
        torques = pose.generalised_force(dynamics.count, pose.tip, force, np.zeros(3))[6:]
        residual = torques - dynamics.stiffness * (angles - dynamics.neutral)
        load = pose.force_stiffness(dynamics.count, pose.tip, force)
        angles = angles + np.linalg.solve(springs + load, residual)
    assert np.abs(residual).max() < 1e-13
    return angles


def at_rest(scene: Scene, time: float = 8.0) -> np.ndarray:
    steps = round(time / scene.time_step)
    return np.array(rows_of(dataclasses.replace(scene, every=steps), steps))[-1, 1:]


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("force", "step", "integrator"),
    [
        (1.0, 1e-3, "implicit"),
        (1.0, 5e-3, "implicit"),
        (4.0, 5e-3, "implicit"),
        (4.0, 5e-3, "euler"),
    ],
)
def test_a_cantilever_rests_where_springs_and_load_balance(
    force: float, step: float, integrator: str
) -> None:
    scene = cantilever({"force": [force, 0, 0]}, time_step=step, integrator=integrator)
    exact = equilibrium(scene.manipulators[0].compiled.chain, np.array([force, 0, 0]))
    assert at_rest(scene, 10) == pytest.approx(exact, abs=1e-9)


@pytest.mark.moderate
def test_a_small_load_meets_the_stiffness_of_the_tip() -> None:
    """The deflection of a beam of ten joints at the middles of its tenths: P sum(arm² / k)."""
    scene = dataclasses.replace(cantilever({"force": [1e-4, 0, 0]}), columns=("tip_position",))
    deflection = at_rest(scene)[0]
    arms = 1 - (np.arange(10) + 0.5) / 10
    assert deflection == pytest.approx(1e-4 * (arms**2 / 10).sum(), rel=1e-7)


@pytest.mark.moderate
@pytest.mark.parametrize("frame", ["world", "body"])
def test_an_end_moment_bends_every_joint_alike(frame: str) -> None:
    scene = cantilever({"moment": [0, 3, 0], "frame": frame})
    assert at_rest(scene) == pytest.approx([0.3] * 10, abs=1e-9)


def test_what_is_recorded_as_actuation_has_no_load_in_it() -> None:
    scene = cantilever({"moment": [0, 3, 0]})
    rows = np.array(rows_of(dataclasses.replace(scene, columns=("actuation",)), 20))
    assert np.array_equal(rows[:, 1:], np.zeros((len(rows), 1)))


@pytest.mark.parametrize("base", ["static", "free"])
def test_where_rows_fall_changes_nothing_under_a_load(base: str) -> None:
    """Though actuation that is steady is not set anew, and the load goes on and off in a block."""
    load = {
        "force": [1, 0, 0.5],
        "frame": "body",
        "waypoints": [[0, 0], [0.0105, 1], [0.0505, 0]],
        "interpolation": "step",
    }
    runs = []
    for every in (1, 7):
        scene = cantilever(load, every=every)
        one = dataclasses.replace(scene.manipulators[0], base=base)
        runs.append(np.array(rows_of(dataclasses.replace(scene, manipulators=(one,)), 105)))
    assert np.abs(runs[0]).max() > 1e-3
    assert np.array_equal(runs[0][::7], runs[1])


# The hinge of test_physics turns about x; its tip is 1 m away, along z. Neutral angle 0.3 rad,
# 50 N·m/rad, 0.5 N·m·s/rad.
def pushed_hinge(frame: Frame, force: float, integrator: str, step: float) -> np.ndarray:
    """Return time [s] and angle [rad], pushed along -y at the tip with a force [N]."""
    load = ExternalLoad(1, (0, 0, 1), (0, -force, 0), (0, 0, 0), frame, ((0, 1),), "linear", False)
    scene = dataclasses.replace(
        pendulum_scene(integrator, step, loads=(load,)), columns=("joint_angles",)
    )
    return np.array(rows_of(scene, round(1 / step)))


def test_a_follower_force_on_a_hinge_is_a_constant_torque() -> None:
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        rows = pushed_hinge("body", 20, "implicit", step)
        exact = pendulum_angle(rows[:, 0], q0=0.3 + 20 / 50)
        errors.append(np.abs(rows[:, 1] - exact).max())
    assert np.log2(errors[:-1] / np.array(errors[1:])) == pytest.approx(2, abs=0.1)


@pytest.mark.moderate
@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
@pytest.mark.parametrize("frame", ["world", "body"])
def test_every_integrator_brings_a_hinge_to_rest(frame: Frame, integrator: str) -> None:
    """At k (q - q0) = P l for a follower force, and at P l cos q for a dead one."""
    load = ExternalLoad(1, (0, 0, 1), (0, -20, 0), (0, 0, 0), frame, ((0, 1),), "linear", False)
    scene = pendulum_scene(integrator, 2e-3, loads=(load,))
    angle = 0.7
    for _ in range(100):
        angle = 0.3 + 20 / 50 * (1 if frame == "body" else math.cos(angle))
    assert at_rest(scene, 32)[0] == pytest.approx(angle, abs=1e-9)


def test_explicit_is_its_recursion_under_a_load() -> None:
    angle = rate = 0.0
    for _, found in pushed_hinge("world", 20, "explicit", 1e-3):
        assert found == pytest.approx(angle, rel=1e-13, abs=1e-13)
        torque = 20 * math.cos(angle) - 50 * (angle - 0.3) - 0.5 * rate
        rate += 1e-3 * torque / PENDULUM_INERTIA
        angle += 1e-3 * rate


AXES = {
    "one axis": "cantilever",
    "two axes, off the centreline": "finger",
    "turned limbs": "hand",
    "limbs at a right angle": "starfish",
}


@pytest.mark.parametrize("name", AXES.values(), ids=AXES)
@pytest.mark.parametrize("is_held", [True, False])
def test_joint_torques_are_those_of_the_generalised_force(name: str, is_held: bool) -> None:
    random = np.random.default_rng(3)
    chain = shipped_chain(name)
    lines = []
    for number in range(6):
        link = chain.links[random.integers(1, len(chain.links))].name
        force, moment, point = (random.normal(size=3).round(3).tolist() for _ in range(3))
        frame = ("world", "body")[number % 2]
        lines.append(
            f"{{link: {link}, frame: {frame}, force: {force}, moment: {moment}, point: {point}, "
            "waypoints: [[0, 1], [1, 0.5], [2, 0]]}"
        )
    # the first alone as well: then its force need not be carried inwards
    for loads in (lines[:1], lines[1:2], lines[1:3], lines):
        check_joint_torques(name, ", ".join(loads), is_held, random)


def check_joint_torques(name: str, loads: str, is_held: bool, random: np.random.Generator) -> None:
    scene = scene_from_text(
        f"manipulators: [{{definition: {name}.yaml, rpy: [0.3, -0.8, 1.2], loads: [{loads}]}}]"
    )
    (body,) = make_plan(scene).bodies
    base = body.start.pose
    if not is_held:  # led by a motion: its pose is asked for in every step
        body = dataclasses.replace(body, base="constrained")
    acting_loads = ExternalLoads(body, lambda: base)
    for time in (0.0, 0.7, 1.5, 3.0):
        base = body.start.pose if is_held else Pose.of((0, 0, 0), tuple(random.normal(size=3)))
        angles = random.uniform(-1, 1, len(body.chain.joints))
        expected = acting_loads.force(time, angles)[6:]
        found = acting_loads.joint_torques(time, angles)
        np.testing.assert_allclose(found, expected, atol=1e-13 * max(1.0, np.abs(expected).max()))


def test_joint_torques_about_oblique_axes() -> None:
    chain = chain_of(manipulator(actuator(5, hinge(0.7, 0.5, -0.2), hinge(-0.3, 0.9, 0.1))))
    (body,) = make_plan(scene_from_text("manipulators: [{definition: finger.yaml}]")).bodies
    signal = piecewise_signal(((0.0, 1.0),), "linear", False)
    load = PlannedLoad(4, (0.01, 0.02, 0.03), (1, 2, 3), (4, 5, 6), "world", signal)
    body = dataclasses.replace(body, chain=chain, loads=(load,))
    loads = ExternalLoads(body, lambda: body.start.pose)
    angles = np.linspace(-0.9, 1.1, 5)
    np.testing.assert_allclose(
        loads.joint_torques(0, angles), loads.force(0, angles)[6:], atol=1e-13
    )
    assert loads.joint_torques(0, angles)[4] == 0  # beyond the load


def test_infinite_angles_give_no_torques_for_the_monitor_to_find() -> None:
    (body,) = make_plan(cantilever({"force": [1, 0, 0]})).bodies
    loads = ExternalLoads(body, lambda: body.start.pose)
    for value in (math.inf, math.nan):
        assert np.isnan(loads.joint_torques(0, np.full(10, value))).any()
    assert np.isfinite(loads.joint_torques(0, ANGLES)).all()
