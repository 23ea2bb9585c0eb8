"""The whole run against theory: closed forms, conservation, and another simulator."""

from __future__ import annotations

import dataclasses
import itertools
import math
import time

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.scene.model import Scene
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.integrator import spinning_base
from tests.builders.fingers import (
    THROWN_FINGER,
    error_of_struck_finger,
    error_of_thrown_finger,
    spinning_finger,
    struck_finger,
    struck_finger_in_mujoco,
)
from tests.builders.momentum import centre_of_mass, loss_of_momentum, velocity_of_centre
from tests.builders.mujoco_reference import mujoco_model, mujoco_trajectory
from tests.builders.pendulum import PENDULUM_INERTIA, error_of_pendulum, pendulum_scene
from tests.builders.runs import rows_of
from tests.builders.scenes import JOINTS, scene_from_file, scene_from_text


def test_a_hinge_rings_at_its_frequency_and_decays_at_its_rate() -> None:
    rows = np.array(rows_of(pendulum_scene("implicit", 1e-4), 20_000))
    times, deflection = rows[:, 0], rows[:, 1] - 0.3
    crossings = np.flatnonzero(np.diff(np.sign(deflection)))
    fractions = deflection[crossings] / (deflection[crossings] - deflection[crossings + 1])
    zeros = times[crossings] + 1e-4 * fractions
    decay = 0.5 / (2 * PENDULUM_INERTIA)
    assert np.diff(zeros).mean() == pytest.approx(
        math.pi / math.sqrt(50 / PENDULUM_INERTIA - decay**2), rel=1e-5
    )
    peaks = [np.abs(deflection[a:b]).max() for a, b in itertools.pairwise(crossings)]
    measured = -np.polyfit(np.arange(len(peaks)), np.log(peaks), 1)[0] / np.diff(zeros).mean()
    assert measured == pytest.approx(decay, rel=1e-3)


@pytest.mark.parametrize(("integrator", "order"), [("implicit", 2), ("euler", 1), ("explicit", 1)])
def test_the_error_falls_with_the_order_of_the_integrator(integrator: str, order: int) -> None:
    errors = [error_of_pendulum(integrator, step) for step in (2e-3, 1e-3, 5e-4, 2.5e-4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - order) < 0.1), (errors, orders)


def test_rates_are_those_of_the_instant() -> None:
    errors = []
    for step in (2e-3, 1e-3):
        rows = np.array(
            rows_of(pendulum_scene("implicit", step, initial_rates=(2.0,)), round(0.5 / step))
        )
        fine = np.array(rows_of(pendulum_scene("implicit", 5e-5, initial_rates=(2.0,)), 10_000))
        errors.append(np.abs(rows[:, 2] - fine[:: round(step / 5e-5), 2]).max())
    assert 3.5 < errors[0] / errors[1] < 4.5, errors


def test_explicit_is_its_recursion() -> None:
    scene = pendulum_scene("explicit", 1e-3)
    rows = np.array(rows_of(scene, 1000))
    angle = rate = 0.0
    for row in rows:
        assert row[1:] == pytest.approx([angle, rate], rel=1e-13, abs=1e-13)
        rate += 1e-3 * (-50 * (angle - 0.3) - 0.5 * rate) / PENDULUM_INERTIA
        angle += 1e-3 * rate


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    return struck_finger_in_mujoco()


@pytest.mark.moderate
def test_the_finger_moves_as_in_another_simulator(reference: np.ndarray) -> None:
    errors = [error_of_struck_finger(reference, step) for step in (2e-3, 1e-3, 5e-4)]
    assert errors[1] < 5e-4
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 2) < 0.15), (errors, orders)


def test_backward_euler_moves_the_finger_with_first_order(reference: np.ndarray) -> None:
    errors = [error_of_struck_finger(reference, step, "euler") for step in (1e-3, 5e-4, 2.5e-4)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 1) < 0.1), (errors, orders)


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_the_world_scale_changes_nothing_but_rounding(integrator: str) -> None:
    columns = ("joint_angles", "joint_rates", "spring_torques", "actuation", "tip_position")
    results = []
    for length, mass in ((1.0, 1.0), (20.0, 1.0), (8.0, 1000.0)):
        scene = struck_finger(1e-3, integrator, columns=columns)
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
    model = mujoco_model(chain, scene.gravity, 1e-3)
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
            THROWN_FINGER if base == "free" else "manipulators: [{definition: finger.yaml}]",
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


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_a_free_chain_keeps_its_momentum(integrator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rates are half a step behind the angles, so momentum is known to first order at best.

    The linear one falls with the second order all the same, because the base is corrected too.
    """
    monkeypatch.setattr(spinning_base, "spin_to_follow", lambda time_step: math.inf)
    coarse, fine = (loss_of_momentum(spinning_finger(step, integrator)) for step in (1e-3, 2.5e-4))
    assert fine[0] < 3e-4, fine
    assert fine[1] < 2e-3, fine
    assert coarse[0] / fine[0] > 10, (coarse, fine)
    assert coarse[1] / fine[1] > 6, (coarse, fine)


@pytest.mark.moderate
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_a_free_chain_whose_momentum_is_followed_keeps_it_better(
    integrator: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is left is that rates are half a step behind the angles."""
    monkeypatch.setattr(spinning_base, "spin_to_follow", lambda time_step: 0.0)
    coarse, fine = (loss_of_momentum(spinning_finger(step, integrator)) for step in (1e-3, 2.5e-4))
    assert fine[0] < 1e-4, fine
    assert fine[1] < 7e-4, fine
    assert np.divide(coarse, fine) == pytest.approx(4, rel=0.1)


def test_the_centre_of_mass_of_a_free_chain_moves_straight() -> None:
    """Where the start, the actuation and the bending are violent, as in `free_chain`."""
    deviations = []
    for step in (1e-3, 5e-4):
        plan = spinning_finger(step, "implicit")
        with BulletWorld(plan) as world:
            before = centre_of_mass(world)
            run.run(plan, world, lambda row: None, round(0.5 / step), time.perf_counter)
            moved = (centre_of_mass(world) - before) / plan.scale.length
        deviations.append(np.linalg.norm(moved - 0.5 * velocity_of_centre(plan)))
    assert deviations[0] < 1e-3
    assert deviations[0] / deviations[1] > 3


@pytest.mark.parametrize("base", ["static", "free"])
def test_what_is_recorded_does_not_change_what_happens(base: str) -> None:
    """To the last bit, though a body is checked every few steps only."""
    runs = []
    for every, columns in (
        (1, ("joint_angles", "joint_rates", "base_pose")),
        (7, ("joint_angles",)),
    ):
        scene = struck_finger(1e-3, every=every, columns=columns)
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
        scene = struck_finger(step, gravity=(0.0, 0.0, -4 * 9.81))
        turned = dataclasses.replace(scene.manipulators[0], rpy=rpy)
        scene = dataclasses.replace(scene, manipulators=(turned,))
        if truth is None:
            chain = turned.compiled.chain
            axes = np.array(geometry.rotation_from_rpy(rpy))
            torques = [0.05 if joint.channel == 0 else 0.02 for joint in chain.joints]
            model = mujoco_model(chain, axes.T @ scene.gravity, 1e-5)
            times = [0.1 * index for index in range(1, 11)]
            truth = mujoco_trajectory(model, lambda time, torques=torques: torques, times)
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


@pytest.mark.moderate
def test_a_thrown_finger_moves_as_in_another_simulator() -> None:
    angle, place = np.array([error_of_thrown_finger(step) for step in (2e-3, 1e-3, 5e-4)]).T
    assert angle[1] < 1e-4, angle
    assert place[1] < 4e-4, place
    assert np.log2(angle[:-1] / angle[1:]) == pytest.approx(2, abs=0.25)
    assert np.log2(place[:-1] / place[1:]) == pytest.approx(1.7, abs=0.3)
