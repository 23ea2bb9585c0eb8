"""What is expected of a moved base: its acceleration, as far as it is seen."""

from __future__ import annotations

import json

import pytest

from somo_cli.analysis.modal_excitation import Acceleration
from somo_cli.analysis.stability import forecast_of
from somo_cli.scene.signals import piecewise_signal
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.scenes import scene_from_text


def test_the_acceleration_is_the_second_derivative() -> None:
    smooth = Acceleration(piecewise_signal([(0, 0), (1, 2)], "cubic", False))  # 2 (3 t² - 2 t³)
    assert smooth.at(0.25) == pytest.approx(2 * (6 - 12 * 0.25))
    assert smooth.at(5.0) == pytest.approx(0, abs=1e-9)
    assert smooth.constant_from == pytest.approx(1, abs=0.01)


def test_a_jump_of_the_velocity_counts_and_the_start_does_not() -> None:
    straight = Acceleration(piecewise_signal([(0, 0), (1, 3)], "linear", False))
    assert straight.at(0.0) == pytest.approx(0, abs=1e-9)
    assert straight.at(0.5) == pytest.approx(0, abs=1e-9)
    # it loses 3 m/s within the width
    assert straight.at(1.0) * straight.width == pytest.approx(-3)
    assert straight.constant_until(0.5) == 0.5


def expected_error(motion: dict[str, object]) -> float:
    one = {"definition": "finger.yaml", "base": "constrained", "motion": motion}
    plan: Plan = make_plan(scene_from_text(json.dumps({"manipulators": [one]})))
    return forecast_of(plan, plan.bodies[0], ()).motion.error("implicit", plan.time_step)


def test_a_wilder_motion_is_expected_to_cost_more() -> None:
    still = expected_error({"translation": [[0, 0, 0, 0]]})
    slow = expected_error({"translation": [[0, 0, 0, 0], [2, 0.1, 0, 0]]})
    fast = expected_error({"translation": [[0, 0, 0, 0], [0.1, 0.1, 0, 0]]})
    turned = expected_error({"rotation": [[0, 0, 0, 0], [0.1, 0.5, 0, 0]]})
    assert slow < 0.1 * fast
    assert slow < 0.1 * turned
    assert fast != still
