"""MJCF of every shipped definition and scene, read by MuJoCo: the same model, the same rest."""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest

from somo_cli.exchange import mjcf
from somo_cli.exchange.mjcf_scene import render_scene
from somo_cli.exchange.unwritten import parts_not_in_mjcf, recorded_of
from somo_cli.manipulator.compile import compile_definition
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.scene.columns import header
from somo_cli.scene.model import ALL_OBJECT_QUANTITIES, ALL_QUANTITIES
from tests.builders.definitions import actuator, compiled, document_of, hinge, manipulator
from tests.builders.runs import rows_of
from tests.builders.shipped import (
    SHIPPED_CHAINS,
    SHIPPED_SCENES,
    shipped_chain,
    shipped_scene,
)

STEP = 5e-4  # s


def model_of(text: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(text)


def full_inertia(model: mujoco.MjModel, body: int) -> np.ndarray:
    """Return mass, centre and inertia of a body in its own axes."""
    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, model.body_iquat[body])
    turned = axes.reshape(3, 3)
    return turned @ np.diag(model.body_inertia[body]) @ turned.T


@pytest.mark.parametrize("name", SHIPPED_CHAINS)
def test_mujoco_reads_masses_inertias_springs_and_limits(name: str) -> None:
    chain = shipped_chain(name)
    model = model_of(mjcf.render_chain(chain, STEP))
    assert (model.nbody, model.njnt) == (1 + len(chain.links), len(chain.joints))
    for link in chain.links:
        body = model.body(link.name).id
        xx, xy, xz, yy, yz, zz = link.inertial.inertia
        assert model.body_mass[body] == link.inertial.mass
        np.testing.assert_array_equal(model.body_ipos[body], link.inertial.centre)
        expected = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        scale = np.abs(expected).max()
        np.testing.assert_allclose(full_inertia(model, body), expected, atol=1e-9 * scale)
    for number, joint in enumerate(chain.joints):
        assert model.joint(number).name == joint.name
        assert np.ravel(model.jnt_stiffness[number])[0] == joint.stiffness
        assert model.qpos_spring[number] == joint.neutral_position
        assert np.ravel(model.dof_damping[number])[0] == joint.damping
        assert np.ravel(model.dof_frictionloss[number])[0] == joint.friction
        assert model.dof_armature[number] == 0
        np.testing.assert_allclose(model.jnt_axis[number], joint.axis, atol=1e-15)
        assert bool(model.jnt_limited[number]) == joint.is_limited
        if joint.is_limited:
            assert tuple(model.jnt_range[number]) == (joint.lower, joint.upper)
        assert not model.jnt_actfrclimited[number]  # effort is not enforced by a run either


@pytest.mark.parametrize("name", SHIPPED_CHAINS)
def test_forward_kinematics_are_ours(name: str) -> None:
    chain = shipped_chain(name)
    model = model_of(mjcf.render_chain(chain, STEP))
    state = mujoco.MjData(model)
    random = np.random.default_rng(7)
    for _ in range(20):
        angles = random.uniform(-1, 1, len(chain.joints))
        state.qpos[:] = angles
        mujoco.mj_kinematics(model, state)
        poses = link_poses(chain, angles.tolist(), Pose())
        for link, pose in zip(chain.links, poses, strict=True):
            body = state.body(link.name)
            np.testing.assert_allclose(body.xpos, pose.position, atol=1e-9 * chain.length)
            np.testing.assert_allclose(body.xmat.reshape(3, 3), pose.rotation, atol=1e-9)
        for limb in chain.backbones:
            tip = poses[limb.last_link].point(limb.tip)
            site = state.site(f"{limb.prefix}tip").xpos
            np.testing.assert_allclose(site, tip, atol=1e-9 * chain.length)


def test_one_control_is_the_torque_in_every_joint_of_an_axis() -> None:
    chain = shipped_chain("hand")
    model = model_of(mjcf.render_chain(chain, STEP, gravity=(0, 0, 0)))
    state = mujoco.MjData(model)
    state.ctrl[model.actuator("thumb_actuator_0_axis_0").id] = 0.013
    mujoco.mj_forward(model, state)
    (thumb,) = (limb for limb in chain.backbones if limb.name == "thumb")
    expected = [
        0.013 if thumb.first <= number < thumb.last and joint.channel == 0 else 0.0
        for number, joint in enumerate(chain.joints)
    ]
    assert sum(value > 0 for value in expected) == 5
    np.testing.assert_allclose(state.qfrc_actuator, expected, atol=1e-15)


def test_the_same_chain_gives_the_same_bytes_and_exact_numbers() -> None:
    chain = shipped_chain("gauss_finger")
    text = mjcf.render_chain(chain, STEP)
    assert text == mjcf.render_chain(shipped_chain("gauss_finger"), STEP)
    joints = list(ET.fromstring(text).iter("joint"))
    read = [float(one.get("stiffness", 0)) for one in joints if one.get("axis")]
    assert read == [joint.stiffness for joint in chain.joints]


def test_equal_limits_hold_a_joint() -> None:
    locked = hinge(1, 0, 0, limits=[0.2, 0.2, 1, 1])
    chain = compiled(manipulator(actuator(1, locked), world_scale=1)).chain
    model = model_of(mjcf.render_chain(chain, 5e-4, gravity=(0, 0, 0)))
    state = mujoco.MjData(model)
    mujoco.mj_step(model, state, 3000)
    assert state.qpos[0] == pytest.approx(0.2, abs=1e-3)


def test_a_limit_holds_a_stiff_spring() -> None:
    pressed = hinge(
        1, 0, 0, limits=[-0.1, 0.1, 1, 1], joint_neutral_position=0.5, spring_damping=2e-5
    )
    data = manipulator(actuator(1, pressed), world_scale=1)
    chain = compile_definition(document_of(data)).chain
    model = model_of(mjcf.render_chain(chain, 5e-4, gravity=(0, 0, 0)))
    state = mujoco.MjData(model)
    mujoco.mj_step(model, state, 3000)
    assert state.qpos[0] == pytest.approx(0.1, abs=1e-3)


# scenes


@pytest.mark.parametrize("name", SHIPPED_SCENES)
def test_mujoco_takes_every_scene_and_steps_it(name: str) -> None:
    scene = shipped_scene(name)
    model = model_of(render_scene(scene, name, 2e-4))
    state = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, state, model.key("start").id)
    mujoco.mj_step(model, state, 20)
    assert np.isfinite(state.qpos).all()
    assert state.warning.number.sum() == 0
    for one in scene.manipulators:
        for number, joint in enumerate(one.compiled.chain.joints):
            at = model.joint(f"{one.name}.{joint.name}").qposadr[0]
            assert model.key_qpos[0, at] == one.initial_angles[number]


def test_friction_is_the_product() -> None:
    scene = shipped_scene("starfish_scene")
    model = model_of(render_scene(scene, "starfish", STEP))
    assert scene.ground is not None
    own = scene.manipulators[0].surfaces.links.friction
    assert model.npair > 0
    np.testing.assert_allclose(model.pair_friction[:, :2], 0.8 * own, rtol=1e-15)
    assert set(model.pair_dim) == {3}
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()


def test_sensors_are_what_the_scene_records() -> None:
    scene = shipped_scene("lift_scene")
    model = model_of(render_scene(scene, "lift", STEP))
    names = {model.sensor(number).name for number in range(model.nsensor)}
    joints = {
        f"{one.name}.{joint.name}.angle_rad"
        for one in scene.manipulators
        for joint in one.compiled.chain.joints
    }
    assert joints <= names
    state = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, state, 0)
    mujoco.mj_forward(model, state)
    one = scene.objects[0]
    place = state.sensor(f"{one.name}.pose.position_m").data
    np.testing.assert_allclose(place, state.body(one.name).xpos, atol=1e-15)


def test_every_quantity_has_a_sensor_or_is_told() -> None:
    pairs = [((one,), ()) for one in ALL_QUANTITIES] + [
        ((), (one,)) for one in ALL_OBJECT_QUANTITIES
    ]
    for columns, of_objects in pairs:
        scene = dataclasses.replace(
            shipped_scene("push_scene"),
            columns=columns,
            object_quantities=of_objects,
            only=(),
        )
        model = model_of(render_scene(scene, "push", STEP))
        told = [part for part in parts_not_in_mjcf(scene) if part.startswith("sensors")]
        assert (model.nsensor > 0) != bool(told), (columns, of_objects)


@pytest.mark.moderate
def test_sensors_read_what_a_run_records() -> None:
    scene = dataclasses.replace(
        shipped_scene("starfish_scene"),
        columns=("joint_angles", "base_pose", "tip_position", "tip_velocity", "bending_angles"),
        manipulators=(
            dataclasses.replace(
                shipped_scene("starfish_scene").manipulators[0],
                initial_angles=tuple(np.linspace(-0.2, 0.2, 30).tolist()),
                initial_rates=tuple(np.linspace(0.3, -0.4, 30).tolist()),
                linear_velocity=(0.1, 0.2, -0.3),
                angular_velocity=(0.5, -0.4, 0.3),
                rpy=(0.2, 0.1, 0.4),
                position=(0.1, 0.2, 0.4),
            ),
        ),
        every=1,
        time_step=1e-6,  # the velocities of the first row are known to the first order of it
    )
    model = model_of(render_scene(scene, "star", STEP))
    state = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, state, 0)
    mujoco.mj_forward(model, state)
    names = header(recorded_of(scene))
    row = dict(zip(names, rows_of(scene, 1)[0], strict=True))
    for name in names:
        if not name.endswith((".angle_rad", ".bend_rad")):
            continue
        assert state.sensor(name).data[0] == pytest.approx(row[name], abs=1e-12)
    for limb in scene.manipulators[0].compiled.chain.limbs:
        for sensor, start, unit in (
            (f"starfish.{limb.name}_tip.position_m", f"starfish.{limb.name}_tip", "m"),
            (
                f"starfish.{limb.name}_tip_velocity.m_per_s",
                f"starfish.{limb.name}_tip_velocity",
                "m_per_s",
            ),
        ):
            own = [row[f"{start}.{axis}_{unit}"] for axis in "xyz"]
            np.testing.assert_allclose(state.sensor(sensor).data, own, atol=1e-5)


def test_what_a_scene_has_and_mjcf_has_not_is_told() -> None:
    assert parts_not_in_mjcf(shipped_scene("snake_scene")) != ()
    told = " ".join(parts_not_in_mjcf(shipped_scene("crawler_scene")))
    assert "anisotropic friction" in told
    assert "contact stiffness" in told
