"""The same chain in MuJoCo, an independent simulator, as a reference for motion without contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.urdf import render
from somo_cli.simulation.scene import Load
from somo_cli.simulation.signal import through

FLOATING = (
    '<link name="world"/><joint name="floating" type="floating">'
    '<parent link="world"/><child link="base"/></joint>'
)


def model_of(
    chain: Chain, gravity: Sequence[float], time_step: float, is_free: bool = False
) -> mujoco.MjModel:
    """Read our URDF into MuJoCo, which has no springs in URDF: they are set afterwards.

    A free base adds 7 numbers to the front of qpos and 6 to that of qvel.
    """
    text = render(chain).replace(
        f'<robot name="{chain.name}">',
        f'<robot name="{chain.name}"><mujoco><compiler fusestatic="true" '
        f'discardvisual="true" balanceinertia="false"/></mujoco>{FLOATING * is_free}',
    )
    model = mujoco.MjModel.from_xml_string(text)
    names = [
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, index) for index in range(model.njnt)
    ]
    assert names[is_free:] == [joint.name for joint in chain.joints]
    model.opt.gravity[:] = gravity
    model.opt.timestep = time_step
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= (
        mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    )
    count = len(chain.joints)
    # a row of one or of three numbers, by MuJoCo's version
    model.jnt_stiffness[-count:] = np.reshape(
        [joint.stiffness for joint in chain.joints], (-1, *[1] * (model.jnt_stiffness.ndim - 1))
    )
    model.qpos_spring[-count:] = [joint.neutral_position for joint in chain.joints]
    damping = model.dof_damping.reshape(model.nv, -1)[-count:, 0]
    assert np.allclose(damping, [joint.damping for joint in chain.joints])
    model.dof_frictionloss[:] = 0
    return model


def trajectory(
    model: mujoco.MjModel,
    torques: Callable[[float], Sequence[float]],
    times: Sequence[float],
    angles: Sequence[float] | float = 0.0,
) -> np.ndarray:
    """Return joint angles at the times, shape (len(times), n), from rest at `angles`."""
    state = mujoco.MjData(model)
    state.qpos[:] = angles
    rows = []
    done = 0
    for time in times:
        until = round(time / model.opt.timestep)
        for step in range(done, until):
            state.qfrc_applied[:] = torques((step + 0.5) * model.opt.timestep)
            mujoco.mj_step(model, state)
        done = until
        rows.append(state.qpos.copy())
    return np.array(rows)


def trajectory_under_loads(
    model: mujoco.MjModel, loads: Sequence[Load], times: Sequence[float]
) -> np.ndarray:
    """Return qpos at the times, from rest at zero, with loads [SI] evaluated in every stage.

    The model's bodies are the links in order; a base that is not free is none of them.
    """
    is_free = model.nq > model.nv
    signals = [through(load.waypoints, load.interpolation, load.repeat) for load in loads]

    def push(model: mujoco.MjModel, state: mujoco.MjData) -> None:
        state.xfrc_applied[:] = 0
        for load, signal in zip(loads, signals, strict=True):
            body = load.link + is_free
            axes = state.xmat[body].reshape(3, 3)
            turned = axes if load.frame == "body" else np.eye(3)
            force = signal.at(state.time) * (turned @ load.force)
            moment = signal.at(state.time) * (turned @ load.moment)
            arm = state.xpos[body] + axes @ load.point - state.xipos[body]
            state.xfrc_applied[body, :3] += force
            state.xfrc_applied[body, 3:] += moment + np.cross(arm, force)

    state = mujoco.MjData(model)
    rows = []
    mujoco.set_mjcb_control(push)
    try:
        for time in times:
            while state.time < time - 0.5 * model.opt.timestep:
                mujoco.mj_step(model, state)
            rows.append(state.qpos.copy())
    finally:
        mujoco.set_mjcb_control(None)
    return np.array(rows)
