"""A run says by itself in how many steps it did not predict contact forces."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from somo_cli.simulation.integrator.contact_prediction import PredictionCount
from somo_cli.simulation.monitoring.unpredicted_contact import unpredicted_contact
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS, scene_from_file

CRAWLER = str(DEFINITIONS / "crawler_scene.yaml")
ISOTROPIC = "manipulators[0].surface={friction: 0.5, contact_stiffness: 1500, contact_damping: 10}"


@pytest.fixture(scope="module")
def plan() -> Plan:
    return make_plan(scene_from_file("push_scene.yaml"))


def counted(**values: int) -> PredictionCount:
    return PredictionCount(**values, first=(40, (0, 1)))


@pytest.mark.parametrize(
    "count",
    [
        PredictionCount(),
        PredictionCount(steps=1000, felt=1000, most_points=48),
        counted(steps=1000, felt=1000, crowded=5, most_points=60, unsolved=5),
    ],
)
def test_nothing_is_said_of_few_steps(plan: Plan, count: PredictionCount) -> None:
    assert unpredicted_contact(plan, count) is None


def test_the_finding_says_how_often_and_why(plan: Plan) -> None:
    found = unpredicted_contact(
        plan, counted(steps=2000, felt=1000, crowded=30, most_points=60, unsolved=5)
    )
    assert found is not None
    assert (found.code, found.time) == ("contact-unpredicted", 40 * plan.time_step)
    assert found.names == ("finger", "cube")
    assert found.message == (
        "contact forces were not predicted in 35 of the 1000 steps with contact: in 30 of them up "
        "to 60 points pressed, and at most 48 with friction are predicted; in 5 of them no forces "
        "were found that obey friction; forces may shake"
    )
    assert dict(found.values) == {"steps_with_contact": 1000, "steps_unpredicted": 35}


def prediction_of(output: Path) -> dict[str, int]:
    told = json.loads(output.with_suffix(".meta.json").read_text("utf-8"))["contact_prediction"]
    assert told["most_points"] == 96
    assert told["steps_with_contact"] > 5
    assert told["steps_without_solution"] == 0
    counts: dict[str, int] = told
    return counts


@pytest.mark.moderate
def test_a_run_with_more_points_than_are_predicted_says_so(somo: Somo, tmp_path: Path) -> None:
    pytest.importorskip("pybullet")
    output = tmp_path / "rows.csv"
    ended = somo("run", CRAWLER, "--steps", "12", "-q", "-o", str(output), "--set", ISOTROPIC)
    assert ended.returncode == 0, ended.stderr
    assert ended.stderr.startswith("somo: warning: contact forces were not predicted in ")
    assert "[contact-unpredicted]" in ended.stderr
    (found,) = json.loads(output.with_suffix(".meta.json").read_text("utf-8"))["findings"]
    assert found["names"] == ["crawler"]
    told = prediction_of(output)
    assert told["steps_with_too_many_points"] == told["steps_with_contact"]


@pytest.mark.moderate
def test_as_many_points_without_friction_are_predicted(somo: Somo, tmp_path: Path) -> None:
    """Friction that depends on the direction is ours: to the engine the points have none."""
    pytest.importorskip("pybullet")
    output = tmp_path / "rows.csv"
    ended = somo("run", CRAWLER, "--steps", "12", "-q", "-o", str(output))
    assert (ended.returncode, ended.stderr) == (0, "")
    assert prediction_of(output)["steps_with_too_many_points"] == 0
