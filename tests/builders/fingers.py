"""The shipped finger in violent motion, and the same motion in MuJoCo."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.mujoco_reference import mujoco_model, mujoco_trajectory
from tests.builders.runs import rows_of
from tests.builders.scenes import JOINTS, scene_from_text


def struck_finger(time_step: float, integrator: str = "implicit", **more: object) -> Scene:
    """Return the shipped finger, struck by torques that whip it to 20 rad/s."""
    scene = scene_from_text(
        "manipulators:\n"
        "  - definition: finger.yaml\n"
        "    actuation:\n"
        "      - {actuator: 0, axis: 0, torque: 0.05}\n"
        "      - {actuator: 0, axis: 1, torque: 0.02}\n"
        "record: {columns: [joint_angles]}\n",
        # twice the shipped damping about x, four times about y
        f"{JOINTS}[0].spring_damping=0.001",
        f"{JOINTS}[1].spring_damping=0.003",
    )
    every = round(0.1 / time_step)
    changes = {"time_step": time_step, "integrator": integrator, "every": every, **more}
    return dataclasses.replace(scene, **changes)  # type: ignore[arg-type]


def struck_finger_in_mujoco() -> np.ndarray:
    """Return joint angles [rad] every 0.1 s by MuJoCo's RK4 at 1e-5 s, shape (10, 10)."""
    scene = struck_finger(1e-3)
    chain = scene.manipulators[0].compiled.chain
    torques = [0.05 if joint.channel == 0 else 0.02 for joint in chain.joints]
    times = [0.1 * index for index in range(1, 11)]
    return mujoco_trajectory(mujoco_model(chain, scene.gravity, 1e-5), lambda time: torques, times)


def error_of_struck_finger(
    reference: np.ndarray, time_step: float, integrator: str = "implicit"
) -> float:
    """Return the largest error of a joint angle of the struck finger over one second [rad]."""
    rows = np.array(rows_of(struck_finger(time_step, integrator), round(1 / time_step)))
    return float(np.abs(rows[1:, 1:] - reference).max())


THROWN_FINGER = (
    "manipulators:\n"
    "  - definition: finger.yaml\n"
    "    base: free\n"
    "    rpy: [0.3, -0.4, 1.2]\n"
    "    linear_velocity: [0.1, -0.2, 0.3]\n"
    "    angular_velocity: [1.0, 2.0, -1.5]\n"
)

LIGHT_BASE_AND_DAMPED = (
    "manipulators[0].definition.base_definition.mass=0.03",
    f"{JOINTS}[0].spring_damping=0.001",
    f"{JOINTS}[1].spring_damping=0.003",
)


def spinning_finger(time_step: float, integrator: str) -> Plan:
    """Return a finger thrown into space, spinning, that bends by torques of its own."""
    scene = scene_from_text(
        THROWN_FINGER + "    actuation:\n"
        "      - {actuator: 0, axis: 0, torque: 0.03}\n"
        "      - actuator: 0\n"
        "        axis: 1\n"
        "        waypoints: [[0, 0], [0.25, 0.05], [0.5, 0]]\n"
        "        repeat: true\n"
        "gravity: [0, 0, 0]\n"
        "record: {columns: [joint_angles]}\n",
        *LIGHT_BASE_AND_DAMPED,
    )
    return make_plan(dataclasses.replace(scene, time_step=time_step, integrator=integrator))


def thrown_finger(step: float) -> Scene:
    """Return a finger with a free base, turned and spinning, bent by torques, under gravity."""
    scene = scene_from_text(
        THROWN_FINGER + "    actuation: [{actuator: 0, axis: 0, torque: 0.03}]\n"
        "record: {columns: [joint_angles, base_pose]}\n",
        *LIGHT_BASE_AND_DAMPED,
    )
    return dataclasses.replace(scene, time_step=step, every=round(0.1 / step))


def error_of_thrown_finger(step: float) -> tuple[float, float]:
    """Return the largest error of a joint angle [rad] and of the base's position [m]."""
    rows = np.array(rows_of(thrown_finger(step), round(0.5 / step)))[1:, 1:14]
    difference = np.abs(rows - thrown_finger_in_mujoco())
    return float(difference[:, :10].max()), float(difference[:, 10:].max())


@functools.cache
def thrown_finger_in_mujoco() -> np.ndarray:
    """Return angles [rad] and the position of the base [m] every tenth of a second."""
    states = free_states_in_mujoco(thrown_finger(1e-3), 1e-5, 5)
    return np.hstack([states[:, 7:], states[:, :3]])


def free_states_in_mujoco(scene: Scene, step: float, count: int) -> np.ndarray:
    """Return the state of a free manipulator every tenth of a second, shape (count, 7 + n).

    That is the position of its base [m], its quaternion (w, x, y, z), and its angles [rad]; a
    torque of 0.03 N·m acts on the joints of each actuator's first axis.
    """
    import mujoco

    (one,) = scene.manipulators
    chain = one.compiled.chain
    axes = geometry.rotation_from_rpy(one.rpy)
    x, y, z, w = geometry.quaternion_from_rotation(axes)
    model = mujoco_model(chain, scene.gravity, step, is_free=True)
    state = mujoco.MjData(model)
    state.qpos[3:7] = w, x, y, z
    state.qvel[:3] = one.linear_velocity
    state.qvel[3:6] = np.array(axes).T @ one.angular_velocity  # in the base's axes
    state.qfrc_applied[6:] = [0.03 if joint.channel == 0 else 0.0 for joint in chain.joints]
    rows = []
    for _ in range(count):
        mujoco.mj_step(model, state, round(0.1 / step))
        rows.append(state.qpos.copy())
    return np.array(rows)
