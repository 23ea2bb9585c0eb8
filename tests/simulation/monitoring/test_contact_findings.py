"""What a run finds of contact, in the engine: shaking, energy, motion that passes through."""

from __future__ import annotations

import json

import pytest

from somo_cli.simulation.integrator import contact_prediction
from somo_cli.simulation.monitoring.findings import Finding
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.runs import simulated
from tests.builders.scenes import scene_from_text
from tests.grasp.cases import Grasp


def thrown(speed: float, step: float, distance: float = 0.0) -> tuple[Finding, ...]:
    """Return what is found of a ball of 2 cm that flies past a finger at a distance [m]."""
    data = {
        "time_step": step,
        "gravity": [0, 0, 0],
        "manipulators": [{"definition": manipulator(actuator(5, X), world_scale=20)}],
        "objects": [
            {
                "name": "ball",
                "shape_type": "sphere",
                "dimensions": [0.01],
                "mass": 0.01,
                "position": [distance, -0.3, 0.05],
                "linear_velocity": [0, speed, 0],
            }
        ],
    }
    _, summary = simulated(scene_from_text(json.dumps(data)), round(0.5 / speed / step))
    return summary.findings


def test_a_ball_that_jumps_over_a_finger_in_a_step_is_found() -> None:
    codes = {one.code for one in thrown(20, 2e-3)}  # 4 cm in a step
    assert "contact-missed" in codes


def test_its_hint_is_a_step_at_which_it_is_not_found() -> None:
    (found,) = (one for one in thrown(20, 2e-3) if one.code == "contact-missed")
    assert found.names == ("body", "ball")
    values = dict(found.values)
    assert values["motion_in_a_step_m"] == pytest.approx(0.04, rel=0.05)
    step = float(found.hint.removeprefix("take a step of at most ").removesuffix(" s"))
    assert not any(one.code == "contact-missed" for one in thrown(20, 0.9 * step))


def test_a_fast_ball_that_meets_nothing_is_not_found() -> None:
    assert thrown(20, 2e-3, distance=1.0) == ()


def test_a_slow_ball_is_not_found() -> None:
    assert thrown(1, 1e-3) == ()


@pytest.mark.slow
def test_a_grasp_that_shakes_is_found_and_one_that_holds_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without the prediction of contact the law answers a step late, and the grasp shakes."""
    scene = Grasp(mass_ratio=40).scene(1e-3)
    _, held = simulated(scene, 2400)
    assert held.findings == ()
    monkeypatch.setattr(contact_prediction, "MOST_POINTS", 0)
    _, shaking = simulated(scene, 2400)
    (found, *_) = (one for one in shaking.findings if one.code == "contact-shakes")
    assert "object" in found.names
    assert dict(found.values)["deviation_n"] > 0.005 * dict(found.values)["mean_n"]
    assert 10 < dict(found.values)["frequency_hz"] < 100
