"""What acts in a step is what the scene says of its time, however many steps are taken at once."""

from __future__ import annotations

import json
from typing import Any
from unittest.mock import patch

import pytest

from somo_cli.scene.signals import PiecewiseSignal
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.session import Session
from tests.builders.scenes import scene_from_text

pytest.importorskip("pybullet")

STEPS = 100
# held, a jump within a block of steps, a ramp, held, a jump, held for ever
WAYPOINTS = [[0, 0.001], [0.0195, 0.001], [0.0205, 0.003], [0.04, 0.003], [0.061, 0.002]]


def plan_of(waypoints: list[list[float]], interpolation: str) -> Plan:
    drive = {
        "actuator": 0,
        "axis": 0,
        "waypoints": waypoints,
        "interpolation": interpolation,
    }
    one = {"definition": "finger.yaml", "actuation": [drive]}
    return make_plan(scene_from_text(json.dumps({"time_step": 1e-3, "manipulators": [one]})))


def torques_by_step(plan: Plan, at_once: int) -> list[float]:
    """Return the torque of the first joint in each step."""
    found: list[float] = []
    with BulletWorld(plan) as world:
        session = Session(plan, world)
        (stepper,) = session.steppers
        step_world = world.step

        def step() -> object:
            found.append(float(stepper.law.actuation[0]))
            return step_world()

        world.step = step
        while session.step < STEPS:
            session.actuate()
            session.monitor()
            asked = session.step - session.step % at_once + at_once
            session.advance(session.schedule.pause_after(session.step, asked))
    return found[:STEPS]


@pytest.mark.parametrize("at_once", [1, 3, 8, 100])
@pytest.mark.parametrize("interpolation", ["step", "linear", "cubic"])
def test_every_step_has_the_torque_of_its_time(interpolation: str, at_once: int) -> None:
    plan = plan_of(WAYPOINTS, interpolation)
    signal = plan.bodies[0].drives[0].signal
    expected = [signal.at(step * plan.time_step) for step in range(STEPS)]
    assert len({*expected}) > 2
    assert torques_by_step(plan, at_once) == expected


def test_what_stays_as_it_is_is_not_asked_again() -> None:
    plan = plan_of([[0, 0.002], [0.05, 0.002], [0.0501, 0.003]], "step")
    asked: list[float] = []
    constant_until = PiecewiseSignal.constant_until

    def noted(signal: PiecewiseSignal, time: float) -> float:
        asked.append(time)
        return constant_until(signal, time)

    with patch.object(PiecewiseSignal, "constant_until", noted):
        torques_by_step(plan, 8)
    assert asked == pytest.approx([0.0, 0.048, 0.056])


def test_a_step_asks_for_no_rotation_where_no_object_can_turn() -> None:
    """Nor does it check objects, where there are none."""
    plan = plan_of(WAYPOINTS, "linear")
    checked: list[Any] = []
    with (
        patch("somo_cli.simulation.loop.ObjectRotations.check", checked.append),
        patch("somo_cli.simulation.monitoring.divergence.check_objects", checked.append),
        patch.object(BodyStepper, "gravity_work", checked.append),
    ):
        torques_by_step(plan, 8)
    assert checked == []
