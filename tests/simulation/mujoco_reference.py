"""The same chain in MuJoCo, an independent simulator, as a reference for motion without contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.urdf import render

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
