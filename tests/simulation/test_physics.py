"""The whole run against theory: closed forms, conservation, and another simulator."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
import time
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.scene.model import Scene
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.loading import rows_of, scene_from_file, scene_from_text
from tests.simulation.mujoco_reference import model_of, trajectory

# One link of 0.35 kg·m² about its hinge: a box, so heavy and so long, whose far end has the mass.
HINGE = """
manipulator_name: pendulum
actuator_definitions:
  - n_segments: 1
    link_definition:
      shape_type: box
      dimensions: [0.1, 0.2, 2]
      mass: 2.0
    joint_definitions:
      - {joint_type: continuous, axis: [1, 0, 0], spring_stiffness: 50, spring_damping: 0.5,
         joint_neutral_position: 0.3}
"""
JOINTS = "manipulators[0].definition.actuator_definitions[0].joint_definitions"
# the moving half: 1 kg, 1 m long, 0.2 m wide; about its end m (w² + h²) / 12 + m h² / 4
INERTIA = (0.2**2 + 1) / 12 + 0.25


def hinge(integrator: str, time_step: float, **more: object) -> Scene:
    scene = scene_from_text(HINGE)
    pendulum = dataclasses.replace(scene.manipulators[0], **more)  # type: ignore[arg-type]
    return dataclasses.replace(
        scene,
        integrator=integrator,
        time_step=time_step,
        gravity=(0.0, 0.0, 0.0),
        manipulators=(pendulum,),
        columns=("joint_angles", "joint_rates"),
    )


def exact_angle(times: np.ndarray, k: float = 50.0, d: float = 0.5, q0: float = 0.3) -> np.ndarray:
    """Return the angle of I q'' + d q' + k (q - q0) = 0 from rest at zero."""
    decay = d / (2 * INERTIA)
    omega = math.sqrt(k / INERTIA - decay**2)
    wave = np.cos(omega * times) + decay / omega * np.sin(omega * times)
    return q0 - q0 * np.exp(-decay * times) * wave


def error_of_hinge(integrator: str, time_step: float) -> float:
    rows = np.array(rows_of(hinge(integrator, time_step), round(1 / time_step)))
    return float(np.abs(rows[:, 1] - exact_angle(rows[:, 0])).max())


def test_a_hinge_rings_at_its_frequency_and_decays_at_its_rate() -> None:
    rows = np.array(rows_of(hinge("implicit", 1e-4), 20_000))
    times, deflection = rows[:, 0], rows[:, 1] - 0.3
    crossings = np.flatnonzero(np.diff(np.sign(deflection)))
    fractions = deflection[crossings] / (deflection[crossings] - deflection[crossings + 1])
    zeros = times[crossings] + 1e-4 * fractions
    decay = 0.5 / (2 * INERTIA)
    assert np.diff(zeros).mean() == pytest.approx(
        math.pi / math.sqrt(50 / INERTIA - decay**2), rel=1e-5
    )
    peaks = [np.abs(deflection[a:b]).max() for a, b in itertools.pairwise(crossings)]
    measured = -np.polyfit(np.arange(len(peaks)), np.log(peaks), 1)[0] / np.diff(zeros).mean()
    assert measured == pytest.approx(decay, rel=1e-3)


@pytest.mark.parametrize(("integrator", "order"), [("implicit", 2), ("euler", 1), ("explicit", 1)])
def test_the_error_falls_with_the_order_of_the_integrator(integrator: str, order: int) -> None:
    errors = [error_of_hinge(integrator, step) for step in (2e-3, 1e-3, 5e-4, 2.5e-4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - order) < 0.1), (errors, orders)


def test_rates_are_those_of_the_instant() -> None:
    errors = []
    for step in (2e-3, 1e-3):
        rows = np.array(rows_of(hinge("implicit", step, initial_rates=(2.0,)), round(0.5 / step)))
        fine = np.array(rows_of(hinge("implicit", 5e-5, initial_rates=(2.0,)), 10_000))
        errors.append(np.abs(rows[:, 2] - fine[:: round(step / 5e-5), 2]).max())
    assert 3.5 < errors[0] / errors[1] < 4.5, errors


def test_explicit_is_its_recursion() -> None:
    scene = hinge("explicit", 1e-3)
    rows = np.array(rows_of(scene, 1000))
    angle = rate = 0.0
    for row in rows:
        assert row[1:] == pytest.approx([angle, rate], rel=1e-13, abs=1e-13)
        rate += 1e-3 * (-50 * (angle - 0.3) - 0.5 * rate) / INERTIA
        angle += 1e-3 * rate


def finger(time_step: float, integrator: str = "implicit", **more: object) -> Scene:
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


def truth_of_finger() -> np.ndarray:
    """Joint angles every 0.1 s by MuJoCo's RK4 at 1e-5 s, shape (10, 10)."""
    scene = finger(1e-3)
    chain = scene.manipulators[0].compiled.chain
    torques = [0.05 if joint.channel == 0 else 0.02 for joint in chain.joints]
    times = [0.1 * index for index in range(1, 11)]
    return trajectory(model_of(chain, scene.gravity, 1e-5), lambda time: torques, times)


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    return truth_of_finger()


def error_of_finger(reference: np.ndarray, time_step: float, integrator: str = "implicit") -> float:
    rows = np.array(rows_of(finger(time_step, integrator), round(1 / time_step)))
    return float(np.abs(rows[1:, 1:] - reference).max())


@pytest.mark.moderate
def test_the_finger_moves_as_in_another_simulator(reference: np.ndarray) -> None:
    errors = [error_of_finger(reference, step) for step in (2e-3, 1e-3, 5e-4)]
    assert errors[1] < 5e-4
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 2) < 0.15), (errors, orders)


def test_backward_euler_moves_the_finger_with_first_order(reference: np.ndarray) -> None:
    errors = [error_of_finger(reference, step, "euler") for step in (1e-3, 5e-4, 2.5e-4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 1) < 0.1), (errors, orders)


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_the_world_scale_changes_nothing_but_rounding(integrator: str) -> None:
    columns = ("joint_angles", "joint_rates", "spring_torques", "actuation", "tip_position")
    results = []
    for length, mass in ((1.0, 1.0), (20.0, 1.0), (8.0, 1000.0)):
        scene = finger(1e-3, integrator, columns=columns)
        scale = type(scene.scale)(length, mass)
        results.append(np.array(rows_of(dataclasses.replace(scene, scale=scale), 500)))
    for other in results[1:]:
        assert np.abs(other - results[0]).max() < 1e-9


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
@pytest.mark.parametrize("factor", [1e2, 1e4, 1e6])
def test_a_stiff_finger_settles_on_its_equilibrium(integrator: str, factor: float) -> None:
    """With springs so stiff that h ω is up to thousands; damping grows with the stiffness."""
    scene = scene_from_file(
        "scene.yaml",
        f"{JOINTS}[0].spring_stiffness={0.117 * factor}",
        f"{JOINTS}[0].spring_damping={0.00117 * factor}",
        f"{JOINTS}[1].spring_stiffness={0.41 * factor}",
        f"{JOINTS}[1].spring_damping={0.0041 * factor}",
        "manipulators[0].actuation=[{actuator: 0, axis: 0, torque: 0.05}]",
        "manipulators[0].initial_angles=0.05",
    )
    scene = dataclasses.replace(
        scene, integrator=integrator, every=1000, columns=("joint_angles",), time_step=1e-3
    )
    angles = np.array(rows_of(scene, 2000))[-1, 1:]
    assert angles == pytest.approx(equilibrium(scene), abs=1e-12 + 1e-10 * np.abs(angles).max())


@pytest.mark.moderate
@pytest.mark.parametrize("step", [2e-2, 5e-3, 2e-3])
@pytest.mark.parametrize("ratio", [0.1, 0.2, 2.0])
def test_a_heavily_damped_chain_comes_to_rest(step: float, ratio: float) -> None:
    """Modes whose sign flips in every step grow where the mass matrix is a little old.

    With B = h/2 D + β h² K a chain in which d/k is 0.2 s never came to rest at a step of 5 ms.
    """
    scene = scene_from_file(
        "cantilever_scene.yaml",
        "manipulators[0].loads=[{moment: [0, 1.5, 0]}]",
        f"{JOINTS}[0].spring_damping={10 * ratio}",
        "record={columns: [joint_angles, joint_rates]}",
    )
    time = 10 + 20 * ratio
    scene = dataclasses.replace(scene, time_step=step, every=round(time / step))
    row = np.array(rows_of(scene, round(time / step)))[-1]
    assert row[1:11] == pytest.approx(0.15, abs=1e-4 if ratio > 1 else 1e-9)
    assert np.abs(row[11:]).max() < (1e-4 if ratio > 1 else 1e-9)


def equilibrium(scene: Scene) -> np.ndarray:
    """Return the joint angles at which springs, actuation and gravity balance (Newton)."""
    import mujoco

    chain = scene.manipulators[0].compiled.chain
    model = model_of(chain, scene.gravity, 1e-3)
    state = mujoco.MjData(model)
    stiffness = np.array([joint.stiffness for joint in chain.joints])
    torques = np.array([0.05 if joint.channel == 0 else 0.0 for joint in chain.joints])

    def residual(angles: np.ndarray) -> np.ndarray:
        state.qpos[:], state.qvel[:] = angles, 0
        mujoco.mj_forward(model, state)
        return torques - stiffness * angles - state.qfrc_bias

    angles = np.zeros(len(stiffness))
    for _ in range(50):
        jacobian = np.array(
            [
                (residual(angles + 1e-6 * unit) - residual(angles - 1e-6 * unit)) / 2e-6
                for unit in np.eye(len(angles))
            ]
        ).T
        angles = angles - np.linalg.solve(jacobian, residual(angles))
    assert np.abs(residual(angles)).max() < 1e-14 * max(1.0, float(stiffness.max()))
    return angles


@pytest.mark.parametrize("base", ["static", "free"])
def test_the_recorded_energy_of_an_undamped_finger_stays(base: str) -> None:
    """To second order: the energies are recorded at the instants, not half a step before."""
    drifts = []
    for step in (2.5e-4, 1.25e-4):
        scene = scene_from_text(
            THROWN if base == "free" else "manipulators: [{definition: finger.yaml}]",
            "record={columns: [energy]}",
            "manipulators[0].initial_angles=0.05",
            f"{JOINTS}[0].spring_damping=0",
            f"{JOINTS}[1].spring_damping=0",
        )
        scene = dataclasses.replace(scene, time_step=step, every=round(0.01 / step))
        energy = np.array(rows_of(scene, round(0.5 / step)))[:, 1:]
        total = energy.sum(axis=1)
        exchanged = float(np.ptp(energy, axis=0).max())
        drifts.append(float(np.abs(total - total[0]).max()) / exchanged)
    assert drifts[0] < 1e-2, drifts
    assert 3 < drifts[0] / drifts[1] < 8, drifts


THROWN = (
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


def free_chain(time_step: float, integrator: str) -> Plan:
    """Return a finger thrown into space, spinning, that bends by torques of its own."""
    scene = scene_from_text(
        THROWN + "    actuation:\n"
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


def momentum(world: BulletWorld, plan: Plan) -> tuple[np.ndarray, np.ndarray]:
    """Return linear and angular momentum about the origin, in engine units, from the engine."""
    body: Any = world.bodies[0]
    bullet, index, client = body.engine.module, body.index, body.engine.number
    links = range(-1, bullet.getNumJoints(index, client))
    linear, angular = np.zeros(3), np.zeros(3)
    for link in links:
        if link < 0:
            centre, orientation = bullet.getBasePositionAndOrientation(index, client)
            velocity, spin = bullet.getBaseVelocity(index, client)
        else:
            state = bullet.getLinkState(index, link, 1, 1, client)
            centre, orientation, velocity, spin = state[0], state[1], state[6], state[7]
        dynamics = bullet.getDynamicsInfo(index, link, client)
        axes = np.array(geometry.rotation_from_quaternion(orientation))
        linear += dynamics[0] * np.array(velocity)
        angular += np.cross(centre, dynamics[0] * np.array(velocity))
        angular += axes @ (np.array(dynamics[2]) * (axes.T @ np.array(spin)))
    return linear, angular


def loss_of_momentum(time_step: float, integrator: str) -> tuple[float, float]:
    """Return the change of both momenta over half a second, relative to their size."""
    plan = free_chain(time_step, integrator)
    with BulletWorld(plan) as world:
        before = momentum(world, plan)
        run.run(plan, world, lambda row: None, round(0.5 / time_step), time.perf_counter)
        after = momentum(world, plan)
    changes = [
        np.linalg.norm(b - a) / np.linalg.norm(a) for a, b in zip(before, after, strict=True)
    ]
    return float(changes[0]), float(changes[1])


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_a_free_chain_keeps_its_momentum(integrator: str) -> None:
    """Rates are half a step behind the angles, so momentum is known to first order at best.

    The linear one falls with the second order all the same, because the base is corrected too.
    """
    coarse, fine = (loss_of_momentum(step, integrator) for step in (1e-3, 2.5e-4))
    assert fine[0] < 3e-4, fine
    assert fine[1] < 2e-3, fine
    assert coarse[0] / fine[0] > 10, (coarse, fine)
    assert coarse[1] / fine[1] > 6, (coarse, fine)


def test_the_centre_of_mass_of_a_free_chain_moves_straight() -> None:
    """Where the start, the actuation and the bending are violent, as in `free_chain`."""
    deviations = []
    for step in (1e-3, 5e-4):
        plan = free_chain(step, "implicit")
        with BulletWorld(plan) as world:
            before = centre_of_mass(world)
            run.run(plan, world, lambda row: None, round(0.5 / step), time.perf_counter)
            moved = (centre_of_mass(world) - before) / plan.scale.length
        deviations.append(np.linalg.norm(moved - 0.5 * velocity_of_centre(plan)))
    assert deviations[0] < 1e-3
    assert deviations[0] / deviations[1] > 3


def centre_of_mass(world: BulletWorld) -> np.ndarray:
    body: Any = world.bodies[0]
    bullet, index, client = body.engine.module, body.index, body.engine.number
    total, masses = np.zeros(3), 0.0
    for link in range(-1, bullet.getNumJoints(index, client)):
        if link < 0:
            centre = bullet.getBasePositionAndOrientation(index, client)[0]
        else:
            centre = bullet.getLinkState(index, link, 0, 1, client)[0]
        mass = bullet.getDynamicsInfo(index, link, client)[0]
        total += mass * np.array(centre)
        masses += mass
    return total / masses


def velocity_of_centre(plan: Plan) -> np.ndarray:
    """Return the velocity of the centre of mass at the start [m/s]: v + ω x r, the body stiff."""
    chain, start = plan.bodies[0].chain, plan.bodies[0].start
    origin, moment, masses = np.zeros(3), np.zeros(3), 0.0
    for index, link in enumerate(chain.links):
        origin = origin + (np.array(chain.joints[index - 1].origin) if index else 0.0)
        moment += link.inertial.mass * (origin + link.inertial.centre)
        masses += link.inertial.mass
    arm = np.array(geometry.rotation_from_rpy(start.rpy)) @ (moment / masses)
    velocity = np.array(start.linear_velocity) + np.cross(start.angular_velocity, arm)
    return velocity / plan.scale.length


@pytest.mark.parametrize("base", ["static", "free"])
def test_what_is_recorded_does_not_change_what_happens(base: str) -> None:
    """To the last bit, though the law looks at a body every few steps only."""
    runs = []
    for every, columns in (
        (1, ("joint_angles", "joint_rates", "base_pose")),
        (7, ("joint_angles",)),
    ):
        scene = finger(1e-3, every=every, columns=columns)
        finger_here = dataclasses.replace(scene.manipulators[0], base=base)
        runs.append(np.array(rows_of(dataclasses.replace(scene, manipulators=(finger_here,)), 210)))
    assert np.array_equal(runs[0][::7, :11], runs[1])


@pytest.mark.moderate
def test_a_hanging_finger_moves_as_in_another_simulator() -> None:
    """With gravity taken for that of an upright base, a step of 2 ms was enough to diverge."""
    rpy = (2.5, 0.3, 0.7)
    errors = []
    truth = None
    for step in (2e-3, 1e-3, 5e-4):
        scene = finger(step, gravity=(0.0, 0.0, -4 * 9.81))
        turned = dataclasses.replace(scene.manipulators[0], rpy=rpy)
        scene = dataclasses.replace(scene, manipulators=(turned,))
        if truth is None:
            chain = turned.compiled.chain
            axes = np.array(geometry.rotation_from_rpy(rpy))
            torques = [0.05 if joint.channel == 0 else 0.02 for joint in chain.joints]
            model = model_of(chain, axes.T @ scene.gravity, 1e-5)
            times = [0.1 * index for index in range(1, 11)]
            truth = trajectory(model, lambda time, torques=torques: torques, times)
        rows = np.array(rows_of(scene, round(1 / step)))
        errors.append(float(np.abs(rows[1:, 1:] - truth).max()))
    assert errors[1] < 2e-4, errors
    assert math.log2(errors[0] / errors[2]) / 2 == pytest.approx(2, abs=0.2), errors


@pytest.mark.moderate
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
@pytest.mark.parametrize("step", [5e-3, 2e-2])
def test_a_heavy_hanging_arm_is_stable_at_large_steps(integrator: str, step: float) -> None:
    scene = scene_from_file("arm_scene.yaml")
    scene = dataclasses.replace(scene, integrator=integrator, time_step=step, every=10)
    small = dataclasses.replace(scene, time_step=2e-3, integrator="implicit", every=250)
    rows, fine = np.array(rows_of(scene, round(4 / step))), np.array(rows_of(small, 2000))
    tip = slice(51, 54)  # behind the time and 50 angles
    assert np.abs(rows[-1, tip] - fine[-1, tip]).max() < 0.02  # m, of 0.77


def thrown(step: float) -> Scene:
    """Return a finger with a free base, turned and spinning, bent by torques, under gravity."""
    scene = scene_from_text(
        THROWN + "    actuation: [{actuator: 0, axis: 0, torque: 0.03}]\n"
        "record: {columns: [joint_angles, base_pose]}\n",
        *LIGHT_BASE_AND_DAMPED,
    )
    return dataclasses.replace(scene, time_step=step, every=round(0.1 / step))


def error_of_throw(step: float) -> tuple[float, float]:
    """Return the largest error of a joint angle [rad] and of the base's position [m]."""
    rows = np.array(rows_of(thrown(step), round(0.5 / step)))[1:, 1:14]
    difference = np.abs(rows - thrown_in_mujoco())
    return float(difference[:, :10].max()), float(difference[:, 10:].max())


@pytest.mark.moderate
def test_a_thrown_finger_moves_as_in_another_simulator() -> None:
    angle, place = np.array([error_of_throw(step) for step in (2e-3, 1e-3, 5e-4)]).T
    assert angle[1] < 1e-4, angle
    assert place[1] < 4e-4, place
    assert np.log2(angle[:-1] / angle[1:]) == pytest.approx(2, abs=0.25)
    assert np.log2(place[:-1] / place[1:]) == pytest.approx(1.7, abs=0.3)


@functools.cache
def thrown_in_mujoco() -> np.ndarray:
    """Return angles [rad] and the position of the base [m] every tenth of a second."""
    import mujoco

    scene = thrown(1e-3)
    finger_here = scene.manipulators[0]
    chain = finger_here.compiled.chain
    axes = geometry.rotation_from_rpy(finger_here.rpy)
    x, y, z, w = geometry.quaternion_from_rotation(axes)
    model = model_of(chain, scene.gravity, 1e-5, is_free=True)
    state = mujoco.MjData(model)
    state.qpos[3:7] = w, x, y, z
    state.qvel[:3] = finger_here.linear_velocity
    state.qvel[3:6] = np.array(axes).T @ finger_here.angular_velocity  # in the base's axes
    state.qfrc_applied[6:] = [0.03 if joint.channel == 0 else 0.0 for joint in chain.joints]
    rows = []
    for _ in range(5):
        mujoco.mj_step(model, state, 10_000)
        rows.append([*state.qpos[7:], *state.qpos[:3]])
    return np.array(rows)
