"""Exported scenes move in MuJoCo as ours do: the difference goes with the step of MuJoCo."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
import pytest

from somo_cli.exchange.mjcf_scene import render_scene
from somo_cli.scene.model import Scene
from somo_cli.scene.quantities import channels
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text

TIME = 0.05  # s
STEPS = (2e-4, 1e-4)  # s, of ours; MuJoCo's are a quarter
SCENE = """
manipulators:
  - definition: {definition}.yaml
    base: {base}
    rpy: [0.4, 1.2, -0.3]
    initial_angles: 0.05
    actuation: [{{{limbs}actuator: 0, axis: 0, wave: {{amplitude: 0.01, frequency: 3}}}}]
record: {{columns: [joint_angles]}}
"""


def angles_of_ours(scene: Scene) -> np.ndarray:
    """Return the joint angles at the end [rad]."""
    steps = round(TIME / scene.time_step)
    return np.array(rows_of(dataclasses.replace(scene, every=steps), steps)[-1][1:])


def angles_in_mujoco(scene: Scene, step: float) -> np.ndarray:
    """Return the joint angles at the end [rad], the controls set in the middle of each step."""
    model = mujoco.MjModel.from_xml_string(render_scene(scene, "scene", step))
    state = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, state, 0)
    (one,) = scene.manipulators
    order = channels(one.compiled.chain)
    drives = [(order.index((it.actuator, it.axis)), it.profile.signal()) for it in one.actuation]
    for number in range(round(TIME / step)):
        for control, signal in drives:
            state.ctrl[control] = signal.at((number + 0.5) * step)
        mujoco.mj_step(model, state)
    return state.qpos[-len(one.compiled.chain.joints) :].copy()


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("definition", "base", "limbs"),
    [("finger", "static", ""), ("starfish", "free", "limbs: all, ")],
)
def test_free_motion_converges_to_ours(definition: str, base: str, limbs: str) -> None:
    scene = scene_from_text(SCENE.format(definition=definition, base=base, limbs=limbs))
    apart = []
    for step in STEPS:
        one = dataclasses.replace(scene, time_step=step)
        apart.append(angles_in_mujoco(one, step / 4) - angles_of_ours(one))
    coarse, fine = apart
    assert np.abs(fine).max() < 0.6 * np.abs(coarse).max()
    # without the first order of MuJoCo's integrator
    assert np.abs(2 * fine - coarse).max() < 1e-5
