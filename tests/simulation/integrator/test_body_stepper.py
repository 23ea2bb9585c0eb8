"""One body and its law on a world of a few lines."""

from __future__ import annotations

import dataclasses
import math
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.half_step_start import begin
from somo_cli.simulation.integrator.law_stepper import LawStepper
from somo_cli.simulation.plan.model import Plan
from tests.builders.fake_world import (
    HINGE_DAMPING,
    HINGE_INERTIA,
    HINGE_NEUTRAL,
    HINGE_STIFFNESS,
    FakeWorld,
    plan_of_hinges,
)
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file

STEP = 0.01  # s
START = {"initial_angles": 0.3, "initial_rates": 2.0}


def begun(integrator: str, load: float = 0.0, **more: Any) -> tuple[BodyStepper, FakeWorld, Plan]:
    plan = plan_of_hinges(integrator=integrator, time_step=STEP, **{"one": START, **more})
    world = FakeWorld(plan, load)
    body_stepper = BodyStepper(plan, plan.bodies[0], world.bodies[0])
    begin(plan, world, [body_stepper])
    return body_stepper, world, plan


def test_the_actuation_of_a_time() -> None:
    drive = {"actuator": 0, "axis": 0, "waypoints": [[1, 0], [2, 4]]}
    plan = plan_of_hinges(3, one={"actuation": [drive]})
    body_stepper = BodyStepper(plan, plan.bodies[0], FakeWorld(plan).bodies[0])
    assert body_stepper.law.actuation.tolist() == [0.0, 0.0, 0.0]
    body_stepper.actuate(1.5)
    assert body_stepper.law.actuation.tolist() == [2.0, 2.0, 2.0]
    assert [body_stepper.constant_until(time) for time in (0.0, 1.5, 2.0)] == [1.0, 1.5, math.inf]


def test_without_actuation_nothing_ever_changes() -> None:
    plan = plan_of_hinges(2, one={"actuation": []})
    body_stepper = BodyStepper(plan, plan.bodies[0], FakeWorld(plan).bodies[0])
    body_stepper.actuate(3.0)
    assert body_stepper.law.actuation.tolist() == [0.0, 0.0]
    assert body_stepper.constant_until(0.0) == math.inf


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_a_body_begins_at_its_start(integrator: str) -> None:
    body_stepper, world, _ = begun(integrator, load=1.5)
    assert body_stepper.law.angles.tolist() == [0.3]
    assert world.bodies[0].angles.tolist() == [0.3]
    assert body_stepper.law.rates.tolist() == world.bodies[0].rates.tolist()


@pytest.mark.parametrize("integrator", ["euler", "explicit"])
def test_first_order_laws_begin_with_the_rates_of_the_start(integrator: str) -> None:
    body_stepper, _, _ = begun(integrator, load=1.5)
    assert body_stepper.law.rates.tolist() == [2.0]


def test_the_implicit_law_begins_half_a_step_earlier() -> None:
    body_stepper, _, _ = begun("implicit", load=1.5)
    # a = (M + B)⁻¹ (f + u - K (q - q0) - (D + N) v)
    ((damping,),), ((implicit,),) = body_stepper.law.coefficients.matrices(
        np.full((1, 1), HINGE_INERTIA)
    )
    force = 1.5 + 1.0 - HINGE_STIFFNESS * (0.3 - HINGE_NEUTRAL) - damping * 2.0
    half_change = 0.5 * STEP * force / (HINGE_INERTIA + implicit)
    assert body_stepper.law.rates == pytest.approx([2.0 - half_change], abs=1e-13)


def torque_of_first_push(integrator: str, load: float) -> float:
    body_stepper, world, _ = begun(integrator, load)
    body_stepper.measure()
    body_stepper.apply_torques()
    return float(world.bodies[0].torques[0])


def test_explicit_torques_do_not_know_the_load() -> None:
    expected = 1.0 - HINGE_STIFFNESS * (0.3 - HINGE_NEUTRAL) - HINGE_DAMPING * 2.0
    for load in (0.0, 1.5):
        assert torque_of_first_push("explicit", load) == pytest.approx(expected, abs=1e-13)


def test_the_euler_law_knows_the_load_from_the_start() -> None:
    for load in (0.0, 1.5):
        # the step that backward Euler would make: (M + h D + h² K) dv = h (f - h K v)
        forces = (
            load
            + 1.0
            - HINGE_STIFFNESS * (0.3 - HINGE_NEUTRAL)
            - HINGE_DAMPING * 2.0
            - STEP * HINGE_STIFFNESS * 2.0
        )
        rate = STEP * forces / (HINGE_INERTIA + STEP * HINGE_DAMPING + STEP**2 * HINGE_STIFFNESS)
        torque = HINGE_INERTIA * rate / STEP - load
        assert torque_of_first_push("euler", load) == pytest.approx(torque, abs=1e-12)


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_a_body_in_equilibrium_stays_there(integrator: str) -> None:
    balance = HINGE_NEUTRAL + (1.0 + 1.5) / HINGE_STIFFNESS
    one = {"initial_angles": balance}
    body_stepper, world, _ = begun(integrator, load=1.5, one=one)
    for _ in range(50):
        body_stepper.measure()
        body_stepper.apply_torques()
        world.step()
        body_stepper.read_state()
    assert body_stepper.law.angles == pytest.approx([balance], abs=1e-14)
    assert body_stepper.law.rates == pytest.approx([0.0], abs=1e-13)


def test_the_mass_matrix_is_renewed_when_the_joints_have_moved() -> None:
    body_stepper, world, _ = begun("implicit")
    body = world.bodies[0]
    before = body.mass_matrices
    for move, renewed in ((0.0, 0), (1e-4, 0), (1.0, 1), (1e-4, 0), (-1.0, 1)):
        body.angles = body.angles + move
        body_stepper.read_state()
        body_stepper.inertia.refresh_if_moved()
        assert body.mass_matrices - before == renewed, move
        before = body.mass_matrices


def test_the_fastest_joint_is_known_by_its_speed() -> None:
    plan = plan_of_hinges(3)
    world = FakeWorld(plan)
    body_stepper = BodyStepper(plan, plan.bodies[0], world.bodies[0])
    begin(plan, world, [body_stepper])
    for rates, max_rate in (
        ([1.0, -3.0, 2.0], 3.0),
        ([-1.0, 0.5, 2.0], 2.0),
        ([0.0, 0.0, 0.0], 0.0),
        ([0.0, 1e12, 0.0], 1e12),
    ):
        world.bodies[0].rates = np.array(rates)
        body_stepper.read_state()
        body_stepper.measure()
        assert body_stepper.max_rate == max_rate
    for bad in (math.nan, math.inf, -math.inf):
        world.bodies[0].rates = np.array([1.0, bad, 2.0])
        body_stepper.read_state()
        body_stepper.measure()
        assert math.isnan(body_stepper.max_rate)


def test_how_near_a_limit_is_is_asked_only_where_it_matters() -> None:
    plan = plan_of_hinges(2)
    limited = tuple(
        dataclasses.replace(joint, lower=-2.0, upper=1.0) for joint in plan.bodies[0].chain.joints
    )
    chain = dataclasses.replace(plan.bodies[0].chain, joints=limited)
    plan = dataclasses.replace(plan, bodies=(dataclasses.replace(plan.bodies[0], chain=chain),))
    world = FakeWorld(plan)
    body_stepper = BodyStepper(plan, plan.bodies[0], world.bodies[0])
    begin(plan, world, [body_stepper])
    for angle, enough, room in (
        (0.0, 0.5, 1.0),
        (6e-3, 0.5, 1.0 - 6e-3 * math.sqrt(2)),  # from how far both have moved
        (6e-3, 0.995, 1.0 - 6e-3),
        (0.3, 0.5, 0.7),
        (-1.9, 0.5, 0.1),
    ):
        world.bodies[0].angles = np.full(2, angle)
        body_stepper.read_state()
        body_stepper.inertia.refresh_if_moved()
        assert body_stepper.inertia.clearance(enough) == pytest.approx(room), (angle, enough)


@pytest.mark.parametrize("joints", [(0,), (5,), (0, 1, 2), (1, 3, 5), (0, 2, 3), (0, 1, 3, 4)])
def test_a_drive_reaches_its_joints_however_they_are_spaced(joints: tuple[int, ...]) -> None:
    plan = plan_of_hinges(6)
    drive = dataclasses.replace(plan.bodies[0].drives[0], joints=joints)
    body = dataclasses.replace(plan.bodies[0], drives=(drive,))
    body_stepper = BodyStepper(plan, body, FakeWorld(plan).bodies[0])
    body_stepper.actuate(0.0)
    expected = [1.0 if index in joints else 0.0 for index in range(6)]
    assert body_stepper.law.actuation.tolist() == expected


def test_where_bodies_can_touch_corrections_are_held_for_fewer_steps_as_well() -> None:
    scene = dataclasses.replace(scene_from_file("push_scene.yaml"), time_step=2e-3, every=50)
    held, reuse_steps = set(), LawStepper._reuse_steps

    def reported(law_stepper: LawStepper, change: np.ndarray, max_rate: float) -> int:
        steps = reuse_steps(law_stepper, change, max_rate)
        held.add(steps)
        return steps

    with patch.object(LawStepper, "_reuse_steps", reported):
        rows = np.array(rows_of(scene, 500))
    with patch.object(LawStepper, "_reuse_steps", lambda *_: 1):
        corrected = np.array(rows_of(scene, 500))
    assert held & {2, 4}
    angles = slice(1, 11)
    # the step itself costs 3.3e-4 rad here
    assert 0 < np.abs(rows - corrected)[:, angles].max() < 3e-5
