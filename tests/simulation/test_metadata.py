"""What stands beside the CSV."""

from __future__ import annotations

import dataclasses
import hashlib
import json

import pytest

import somo_cli
from somo_cli.simulation.integrator.contact_prediction import PredictionCount
from somo_cli.simulation.metadata import metadata
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan_report import plain_data
from somo_cli.simulation.run import RunSummary
from tests.builders.scenes import scene_from_file

KEYS = [
    "somo", "engine", "numpy", "python", "platform", "inputs", "overrides", "integrator",
    "time_step_s", "time_step_chosen", "expected_tip_error_relative", "steps",
    "stopped_by", "findings", "contact_prediction", "record_every", "rows", "plan", "columns",
    "world_scale", "manipulators", "simulated_time_s", "run_time_s", "steps_per_second",
    "real_time_factor",
]  # fmt: skip
OF_THE_MACHINE = {"engine", "numpy", "python", "platform"}
OF_THE_RUN = {"run_time_s", "steps_per_second", "real_time_factor"}


@pytest.fixture(scope="module")
def found() -> dict[str, object]:
    plan = make_plan(scene_from_file("scene.yaml"))
    inputs = {"scene.yaml": "manipulators: ü\n", "finger.yaml": ""}
    count = PredictionCount(felt=90, crowded=20, most_points=60, unsolved=1)
    summary = RunSummary(500, 51, 0.25, prediction=count)
    return metadata(plan, summary, inputs, ["a=1", "b=2"], ["time_s", "x"])


def test_the_keys(found: dict[str, object]) -> None:
    assert list(found) == KEYS


def test_the_values(found: dict[str, object]) -> None:
    reported = {key: found[key] for key in KEYS if key not in OF_THE_MACHINE}
    assert reported == {
        "somo": somo_cli.__version__,
        "inputs": {
            "scene.yaml": {"sha256": hashlib.sha256("manipulators: ü\n".encode()).hexdigest()},
            "finger.yaml": {"sha256": hashlib.sha256(b"").hexdigest()},
        },
        "overrides": ["a=1", "b=2"],
        "integrator": "implicit",
        "time_step_s": 1e-3,
        "time_step_chosen": False,
        "expected_tip_error_relative": None,
        "steps": 500,
        "stopped_by": None,
        "findings": [],
        "contact_prediction": {
            "steps_with_contact": 90,
            "most_points": 60,
            "steps_with_too_many_points": 20,
            "steps_without_solution": 1,
        },
        "record_every": 10,
        "rows": 51,
        "plan": plain_data(make_plan(scene_from_file("scene.yaml"))),
        "columns": ["time_s", "x"],
        "world_scale": {"length": 20.0, "mass": 1.0},
        "manipulators": {"finger": {"base": "static", "joints": 10}},
        "simulated_time_s": 0.5,
        "run_time_s": 0.25,
        "steps_per_second": 2000.0,
        "real_time_factor": 2.0,
    }


def test_the_machine_is_named(found: dict[str, object]) -> None:
    assert all(isinstance(found[key], str) and found[key] for key in OF_THE_MACHINE)
    assert str(found["engine"]).startswith("pybullet")


def test_it_is_plain_json(found: dict[str, object]) -> None:
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_a_run_too_short_to_measure_has_no_speed() -> None:
    plan = make_plan(scene_from_file("scene.yaml"))
    found = metadata(plan, RunSummary(0, 1, 0.0), {}, [], [])
    assert (found["steps_per_second"], found["real_time_factor"]) == (None, None)


def test_only_the_run_time_differs_between_equal_runs() -> None:
    plan = make_plan(scene_from_file("scene.yaml"))
    summary = RunSummary(10, 2, 0.5)
    other = dataclasses.replace(summary, wall_time=0.7)
    one, two = (metadata(plan, each, {"a": "b"}, [], ["c"]) for each in (summary, other))
    assert {key for key in KEYS if one[key] != two[key]} == OF_THE_RUN
