"""The same bodies in MuJoCo, at a step so small that its own error is none."""

from __future__ import annotations

import mujoco
import numpy as np

from somo_cli.arrays import Array
from tests.free_bodies.bodies import Spinning


def mujoco_rotation(body: Spinning, time: float, time_step: float = 1e-4) -> Array:
    """Return the orientation of a free body after so long [s]; Runge-Kutta, order four."""
    moments = " ".join(map(repr, body.moments))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option integrator="RK4" timestep="{time_step!r}" gravity="0 0 0"/><worldbody>'
        f'<body><freejoint/><inertial pos="0 0 0" mass="{body.mass!r}" diaginertia="{moments}"/>'
        "</body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.qvel[3:] = body.rate
    for _ in range(round(time / time_step)):
        mujoco.mj_step(model, data)
    turned = np.zeros(9)
    mujoco.mju_quat2Mat(turned, data.qpos[3:7])
    return turned.reshape(3, 3)
