"""Assemblies in motion: against their limbs alone, conservation, and another simulator."""

from __future__ import annotations

import dataclasses
from typing import Any

import mujoco
import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.external_loads import generalised_load_force, load_stiffness
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.integrator import energy_bound, refresh_policy
from somo_cli.simulation.plan.build import make_plan
from tests.builders.matrices import stiffness_by_differences
from tests.builders.momentum import loss_of_momentum
from tests.builders.mujoco_reference import mujoco_model
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text

FINGER = "definition: finger.yaml"
LEFT = ((-0.04, 0.01, 0.02), (0.2, -0.6, 0.3))
RIGHT = ((0.04, 0.0, 0.02), (0.0, 0.6, -0.4))
BODY = "{shape_type: box, dimensions: [0.12, 0.08, 0.02], mass: 0.3}"
PLACED = {
    name: f"{FINGER}, position: {list(at)}, rpy: {list(rpy)}"
    for name, (at, rpy) in (("left", LEFT), ("right", RIGHT))
}
PAIR = f"""
    definition:
      assembly_name: pair
      body_definition: {BODY}
      limbs:
        - {{name: left, {PLACED["left"]}}}
        - {{name: right, {PLACED["right"]}}}
"""
BASE = "    position: [0.1, -0.2, 0.3]\n    rpy: [0.3, -0.2, 0.5]\n"
TORQUES = {("left", 0): 0.03, ("left", 1): 0.01, ("right", 0): -0.02, ("right", 1): 0.02}


def pair(base: str, extra: str = "", **changes: Any) -> Scene:
    entries = "".join(
        f"      - {{limb: {limb}, actuator: 0, axis: {axis}, torque: {torque}}}\n"
        for (limb, axis), torque in TORQUES.items()
    )
    text = f"manipulators:\n  - name: pair\n{PAIR}{BASE}    base: {base}\n{extra}"
    return dataclasses.replace(
        scene_from_text(f"{text}    actuation:\n{entries}"), columns=("joint_angles",), **changes
    )


def alone(limb: str, extra: str = "", **changes: Any) -> Scene:
    """Return the finger of a limb by itself, held where the limb is."""
    at, rpy = LEFT if limb == "left" else RIGHT
    body = Pose.of((0.1, -0.2, 0.3), (0.3, -0.2, 0.5))
    turned = geometry.multiply(body.rotation, geometry.rotation_from_rpy(rpy))
    entries = "".join(
        f"      - {{actuator: 0, axis: {axis}, torque: {TORQUES[limb, axis]}}}\n" for axis in (0, 1)
    )
    scene = scene_from_text(
        f"manipulators:\n  - definition: finger.yaml\n{extra}    actuation:\n{entries}"
    )
    one = dataclasses.replace(
        scene.manipulators[0], position=body.point(at), rpy=geometry.rpy_from_rotation(turned)
    )
    return dataclasses.replace(scene, manipulators=(one,), columns=("joint_angles",), **changes)


def apart_from_alone(integrator: str, step: float) -> float:
    """Return the largest difference of an angle of a limb from that of the finger alone [rad]."""
    settings = {"integrator": integrator, "time_step": step, "every": 10}
    rows = np.array(rows_of(pair("static", **settings), 500))
    largest = 0.0
    for limb, found in {"left": rows[:, 1:11], "right": rows[:, 11:]}.items():
        expected = np.array(rows_of(alone(limb, **settings), 500))[:, 1:]
        assert np.abs(expected).max() > 0.1
        largest = max(largest, float(np.abs(found - expected).max()))
    return largest


@pytest.mark.parametrize(
    ("integrator", "step"), [("explicit", 2e-4), ("implicit", 1e-3), ("euler", 1e-3)]
)
def test_each_limb_of_a_held_body_moves_as_it_does_alone(
    integrator: str, step: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    # a body's inertia is renewed once all its joints together have moved so far, which is sooner
    # with two limbs: without that nothing but rounding is left
    monkeypatch.setattr(refresh_policy, "FAST_REFRESH", 0.0)
    monkeypatch.setattr(refresh_policy, "SLOW_PHASE", 0.0)
    assert apart_from_alone(integrator, step) < 1e-14


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_what_limbs_share_changes_less_than_the_step_does(integrator: str) -> None:
    assert apart_from_alone(integrator, 1e-3) < 5e-5


def free_pair(step: float, integrator: str = "implicit") -> Scene:
    """Return two fingers on a body that tumbles in free flight, weightless, whipped by torques."""
    spin = "    linear_velocity: [0.1, 0.2, 0.05]\n    angular_velocity: [1.0, -2.0, 1.5]\n"
    return pair(
        "free",
        spin,
        time_step=step,
        integrator=integrator,
        gravity=(0.0, 0.0, 0.0),
        every=round(0.1 / step),
    )


def test_a_free_assembly_keeps_its_momentum() -> None:
    """To first order: rates are half a step behind the angles, and the body tumbles."""
    coarse, fine = (loss_of_momentum(make_plan(free_pair(step))) for step in (1e-3, 2.5e-4))
    assert np.all(fine < 1e-4), fine
    assert np.all(coarse / fine > 3.2), (coarse, fine)


def by_mujoco(scene: Scene, step: float) -> np.ndarray:
    """Return joint angles every 0.1 s for half a second, of the scene's only, free manipulator."""
    one = scene.manipulators[0]
    chain = one.compiled.chain
    model = mujoco_model(chain, scene.gravity, step, is_free=True)
    state = mujoco.MjData(model)
    rotation = geometry.rotation_from_rpy(one.rpy)
    x, y, z, w = geometry.quaternion_from_rotation(rotation)
    state.qpos[:7] = (*one.position, w, x, y, z)
    # linear velocity of the frame's origin in the world, spin in the body's own axes
    state.qvel[:3] = one.linear_velocity
    state.qvel[3:6] = geometry.rotate(geometry.transposed(rotation), one.angular_velocity)
    by_channel = {
        (entry.actuator, entry.axis): entry.profile.constant_value for entry in one.actuation
    }
    torques = [by_channel[joint.actuator, joint.channel] for joint in chain.joints]
    state.qfrc_applied[6:] = torques
    rows = []
    for _ in range(5):
        for _ in range(round(0.1 / step)):
            mujoco.mj_step(model, state)
        rows.append(state.qpos[7:].copy())
    return np.array(rows)


@pytest.mark.slow
def test_a_free_assembly_moves_as_in_another_simulator() -> None:
    truth = by_mujoco(free_pair(1e-3), 2e-5)
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        rows = np.array(rows_of(free_pair(step), round(0.5 / step)))
        errors.append(float(np.abs(rows[1:, 1:] - truth).max()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[1] < 5e-5
    assert np.all(np.abs(orders - 2) < 0.2), (errors, orders)


@pytest.mark.parametrize("base", ["free", "constrained", "static"])
def test_inertia_and_weight_are_those_of_the_engine(base: str) -> None:
    plan = make_plan(pair(base))
    chain = ChainDynamics(plan.bodies[0].chain)
    angles = np.random.default_rng(7).uniform(-0.6, 0.6, chain.count)
    pose = chain.at(angles, plan.bodies[0].start.pose)
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        mass = body.mass_matrix(angles.tolist())
        bias = body.bias(angles.tolist(), [0.0] * chain.count, (0.0, 0.0, 0.0))
        weight = body.equivalent_joint_torques(bias)
    own = pose.joint_inertia(has_free_base=base == "free")
    assert np.abs(mass - own).max() < 1e-9 * np.abs(own).max()
    if base == "free":  # gravity moves it as a whole
        assert np.abs(weight).max() < 1e-9 * np.abs(pose.gravity_force(plan.gravity)).max()
        return
    expected = -pose.gravity_force(plan.gravity)[6:]
    assert np.abs(weight - expected).max() < 1e-9 * np.abs(expected).max()


def test_stiffness_of_weight_and_loads_is_minus_their_gradient() -> None:
    plan = make_plan(pair("static", "    loads: [{link: left_tip, force: [0.3, -0.2, 0.1]}]\n"))
    body = plan.bodies[0]
    chain = ChainDynamics(body.chain)
    angles = np.random.default_rng(5).uniform(-0.6, 0.6, chain.count)
    pose = chain.at(angles)

    def weight(at: np.ndarray) -> np.ndarray:
        return chain.at(at).gravity_force(plan.gravity)[6:]

    def load(at: np.ndarray) -> np.ndarray:
        return generalised_load_force(body.loads[0], chain.at(at))[6:]

    for torques, own in (
        (weight, pose.gravity_stiffness(plan.gravity)),
        (load, load_stiffness(body.loads[0], pose, 1.0)),
    ):
        expected = stiffness_by_differences(torques, angles)
        assert np.abs(own - expected).max() < 1e-7 * np.abs(expected).max()
    assert np.abs(load(angles)[10:]).max() == 0.0


def test_the_columns_are_named_and_read_by_limb() -> None:
    scene = pair("static", every=500)
    scene = dataclasses.replace(scene, columns=("tip_position", "actuation", "curvatures"))
    plan = make_plan(scene)
    names = columns.header(plan.recorded)
    last = dict(zip(names, rows_of(plan, 500)[-1], strict=True))
    ends = [f"{limb}_tip.{axis}_m" for limb in ("left", "right") for axis in "xyz"]
    assert names[1:7] == [f"pair.{end}" for end in ends]
    driven = {f"{limb}_actuator_0_axis_{axis}": it for (limb, axis), it in TORQUES.items()}
    assert {name: last[f"pair.{name}.torque_nm"] for name in driven} == pytest.approx(driven)
    assert names[11:] == [
        f"pair.{joint.name}.curvature_per_m" for joint in plan.bodies[0].chain.joints
    ]
    for limb in ("left", "right"):
        lone = dataclasses.replace(alone(limb, every=500), columns=("tip_position",))
        tip = [last[f"pair.{limb}_tip.{axis}_m"] for axis in "xyz"]
        assert tip == pytest.approx(rows_of(lone, 500)[-1][1:], abs=1e-5)


def test_a_wave_runs_through_limbs_and_within_them_through_actuators() -> None:
    scene = scene_from_text(
        f"manipulators:\n  - name: pair\n{PAIR}"
        "    actuation:\n"
        "      - {limbs: [right, left], actuators: all, axis: 0,"
        " wave: {amplitude: 1, frequency: 1, lag: 0.25}}\n"
    )
    (first, second) = scene.manipulators[0].actuation
    assert [first.actuator, second.actuator] == [1, 0]
    phases = [entry.profile.wave.phase for entry in (first, second)]  # type: ignore[union-attr]
    assert phases == [0.0, -0.25]


def test_the_divergence_monitor_follows_every_limb_from_the_body() -> None:
    """What gravity can give beyond the root is the sum of what it can give the limbs."""

    def beyond_the_root(names: tuple[str, ...]) -> float:
        kept = ", ".join(f"{{name: {name}, {PLACED[name]}}}" for name in names)
        text = f"assembly_name: pair\nbody_definition: {BODY}\nlimbs: [{kept}]\n"
        body = make_plan(scene_from_text(text)).bodies[0]
        root = body.chain.links[0].inertial
        return energy_bound._fall_moment(body) - 2 * root.mass * geometry.norm(root.centre)

    left, right = beyond_the_root(("left",)), beyond_the_root(("right",))
    assert left > 0 < right
    assert beyond_the_root(("left", "right")) == pytest.approx(left + right, rel=1e-12)
