"""Models for other programs come to rest where ours do: springs, gravity, loads, neutral angles."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
import pytest

from somo_cli.exchange.mjcf_scene import render_scene
from somo_cli.manipulator.kinematics import link_poses
from somo_cli.scene.model import Manipulator, Scene
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text
from tests.builders.shipped import RESTS


def tips(one: Manipulator, angles: np.ndarray) -> np.ndarray:
    """Return the tips of all limbs in the world, shape (limbs, 3) [m]."""
    chain = one.compiled.chain
    poses = link_poses(chain, angles.tolist(), one.pose)
    return np.array([poses[limb.last_link].point(limb.tip) for limb in chain.backbones])


def rest_of_ours(scene: Scene) -> np.ndarray:
    """Return the joint angles after a long time, at large steps, which our law is stable at."""
    slow = dataclasses.replace(scene, time_step=0.01, every=6000, columns=("joint_angles",))
    return np.array(rows_of(slow, 6000)[-1][1:])


def rest_in_mujoco(scene: Scene) -> np.ndarray:
    """Return the joint angles at which MuJoCo's own forces are in balance, by Newton's method."""
    model = mujoco.MjModel.from_xml_string(render_scene(scene, "rest", 5e-4))
    state = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, state, 0)
    stiffness = model.jnt_stiffness.reshape(model.njnt, -1)[:, 0]

    def unbalanced(angles: np.ndarray) -> np.ndarray:
        state.qpos[:], state.qvel[:] = angles, 0
        mujoco.mj_forward(model, state)
        return state.qfrc_passive + state.qfrc_actuator - state.qfrc_bias

    angles = state.qpos.copy()
    for _ in range(40):
        force = unbalanced(angles)
        columns = [unbalanced(angles + 1e-7 * unit) for unit in np.eye(model.nv)]
        slope = (np.array(columns).T - force[:, None]) / 1e-7
        step = np.linalg.solve(slope, -force)
        angles = angles + step * min(1.0, 0.3 / np.abs(step).max())
    assert np.abs(unbalanced(angles)).max() < 1e-12 * max(1.0, stiffness.max())
    return angles


@pytest.mark.moderate
@pytest.mark.parametrize("name", RESTS)
def test_mujoco_rests_where_a_run_does(name: str) -> None:
    scene = scene_from_text(RESTS[name])
    (one,) = scene.manipulators
    ours = tips(one, rest_of_ours(scene))
    np.testing.assert_allclose(tips(one, rest_in_mujoco(scene)), ours, atol=1e-6)
