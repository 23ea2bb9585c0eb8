"""The same chain in MuJoCo, an independent simulator, as a reference for motion without contact."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.urdf import render
from somo_cli.scene.model import ExternalLoad
from somo_cli.scene.prescribed_motion import PosePath, PrescribedMotion
from somo_cli.scene.signals import PiecewiseSignal, piecewise_signal

FLOATING = (
    '<link name="world"/><joint name="floating" type="floating">'
    '<parent link="world"/><child link="base"/></joint>'
)


def _six_joints() -> str:
    """Return six joints in a row that can take a base anywhere, and links between them."""
    names = ("world", "x", "y", "z", "yaw", "pitch", "base")
    kinds = ("prismatic",) * 3 + ("revolute",) * 3
    axes = ("1 0 0", "0 1 0", "0 0 1", "0 0 1", "0 1 0", "1 0 0")
    text = '<link name="world"/>'
    for number, (kind, axis) in enumerate(zip(kinds, axes, strict=True)):
        parent, child = names[number], names[number + 1]
        if child != "base":  # what they weigh does not matter, since their motion is given
            text += (
                f'<link name="{child}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" '
                'izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            )
        text += (
            f'<joint name="base_{number}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{child}"/><axis xyz="{axis}"/>'
            '<limit lower="-99" upper="99" effort="1" velocity="1"/></joint>'
        )
    return text


SIX_JOINTS = _six_joints()


def mujoco_model(
    chain: Chain,
    gravity: Sequence[float],
    time_step: float,
    is_free: bool = False,
    has_prescribed_base: bool = False,
) -> mujoco.MjModel:
    """Read our URDF into MuJoCo, which has no springs in URDF: they are set afterwards.

    A free base adds 7 numbers to the front of qpos and 6 to that of qvel, a prescribed one 6 to
    both: x, y, z, yaw, pitch, roll.
    """
    text = render(chain).replace(
        f'<robot name="{chain.name}">',
        f'<robot name="{chain.name}"><mujoco><compiler fusestatic="true" '
        f'discardvisual="true" balanceinertia="false"/></mujoco>'
        f"{FLOATING * is_free}{SIX_JOINTS * has_prescribed_base}",
    )
    model = mujoco.MjModel.from_xml_string(text)
    names = [
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, index) for index in range(model.njnt)
    ]
    assert names[6 if has_prescribed_base else is_free :] == [joint.name for joint in chain.joints]
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


def mujoco_trajectory(
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


def mujoco_trajectory_under_loads(
    model: mujoco.MjModel, loads: Sequence[ExternalLoad], times: Sequence[float]
) -> np.ndarray:
    """Return qpos at the times, from rest at zero, with loads [SI] evaluated in every stage.

    The model's bodies are the links in order; a base that is not free is none of them.
    """
    is_free = model.nq > model.nv
    signals = [piecewise_signal(load.waypoints, load.interpolation, load.repeat) for load in loads]

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


def mujoco_trajectory_on_prescribed_base(
    model: mujoco.MjModel, motion: PrescribedMotion, times: Sequence[float]
) -> np.ndarray:
    """Return joint angles at the times, shape (len(times), n), of a prescribed base at the origin.

    The model is one of `model_of` with six joints before those of the chain, whose motion is given;
    the others start at rest. M q'' = forces - M_base a, by Runge and Kutta's method.
    """
    path: PosePath = motion.path_from(Pose())
    signals = (*path.translation, *reversed(path.rotation.components))
    state = mujoco.MjData(model)
    n = model.nv - 6
    mass = np.zeros((model.nv, model.nv))

    def rate_of(time: float, angles_and_rates: np.ndarray) -> np.ndarray:
        angles, rates = angles_and_rates[:n], angles_and_rates[n:]
        prescribed = np.array([_derivatives(one, time) for one in signals])
        state.qpos[:] = [*prescribed[:, 0], *angles]
        state.qvel[:] = [*prescribed[:, 1], *rates]
        mujoco.mj_forward(model, state)
        mujoco.mj_fullM(model, state, mass)
        forces = (state.qfrc_passive - state.qfrc_bias - mass[:, :6] @ prescribed[:, 2])[6:]
        return np.concatenate([rates, np.linalg.solve(mass[6:, 6:], forces)])

    h, now, done = model.opt.timestep, np.zeros(2 * n), 0
    rows = []
    for time in times:
        for step in range(done, round(time / h)):
            t = step * h
            a = rate_of(t, now)
            b = rate_of(t + h / 2, now + h / 2 * a)
            c = rate_of(t + h / 2, now + h / 2 * b)
            d = rate_of(t + h - 1e-12, now + h * c)  # at a waypoint, of the piece before it
            now = now + h / 6 * (a + 2 * b + 2 * c + d)
        done = round(time / h)
        rows.append(now[:n])
    return np.array(rows)


def _derivatives(one: PiecewiseSignal, time: float) -> tuple[float, float, float]:
    """Return value, first and second derivative of a signal."""
    index = max(bisect_right(one.times, time) - 1, 0)
    _, c1, c2, c3 = one.pieces[index]
    s = time - one.times[index]
    return one.at(time), c1 + s * (2 * c2 + 3 * s * c3), 2 * c2 + 6 * s * c3
