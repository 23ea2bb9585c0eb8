"""What ends a run early: exact times, boxes, and rest; and that nothing else changes by it."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
import pytest

from somo_cli.scene.stop_conditions import (
    StopAtRest,
    StopAtTime,
    StopOutsideBox,
    read_stop_conditions,
)
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import Data
from tests.builders.fake_run import FakeRun
from tests.builders.fake_world import FakeWorld, plan_of_hinges
from tests.builders.rigid_objects import CUBE, G, scene_of_objects
from tests.builders.runs import simulated
from tests.builders.scenes import scene_from_text

INFINITE = float("inf")


def test_conditions_as_they_are_written() -> None:
    items: list[Data] = [
        {"time": 2},
        {"object": "cube", "leaves": {"z": [0, 1], "x": [-0.5, 0.5]}},
        {"at_rest": {}},
        {"at_rest": {"for": 1, "after": 2, "speed": 3, "rate": 4}},
    ]
    assert read_stop_conditions(items) == (
        StopAtTime(2.0),
        StopOutsideBox("cube", (-0.5, -INFINITE, 0.0), (0.5, INFINITE, 1.0)),
        StopAtRest(0.5, 0.0, 1e-4, 1e-3),
        StopAtRest(1.0, 2.0, 3.0, 4.0),
    )


def hinges(*conditions: Data, **more: Any) -> Plan:
    record = {"every": more.pop("every", 1), "columns": ["joint_angles", "joint_rates"]}
    return plan_of_hinges(record=record, stop=list(conditions), **more)


@pytest.mark.parametrize(
    ("time", "step", "last"),
    [
        (0.02, 1e-3, 20),
        (0.3, 0.1, 3),  # 0.3 / 0.1 is less than 3, and 3 * 0.1 is more than 0.3
        (0.7, 0.1, 7),
        (0.0201, 1e-3, 21),
        (1e-6, 1e-3, 1),
    ],
)
@pytest.mark.parametrize("every", [1, 7])
def test_times_are_exact(time: float, step: float, last: int, every: int) -> None:
    plan = hinges({"time": 50}, {"time": time}, time_step=step, every=every)
    ended = FakeRun(plan, FakeWorld(plan), 40)
    assert ended.summary is not None
    assert ended.summary.steps == last
    assert ended.times[-1] == pytest.approx(last * step)
    assert ended.summary.rows == len(ended.rows) == len({*range(0, last + 1, every), last})
    assert ended.summary.stopped is not None
    assert ended.summary.stopped.condition == 1
    assert ended.summary.stopped.reason == f"the time is {time:g} s"


def test_the_steps_are_the_upper_bound() -> None:
    plan = hinges({"time": 50}, every=7)
    ended = FakeRun(plan, FakeWorld(plan), 20)
    assert ended.summary is not None
    assert (ended.summary.steps, ended.summary.stopped) == (20, None)
    assert ended.times == pytest.approx([0, 0.007, 0.014, 0.02])  # the last one, too


@pytest.mark.parametrize("every", [1, 3, 8, 1000])
def test_rest_is_found_wherever_rows_fall(every: int) -> None:
    condition: Data = {"at_rest": {"for": 0.6, "rate": 0.5}}
    plan = hinges(condition, every=every)
    # without the condition, a row for each step
    free = dataclasses.replace(plan, stop_conditions=(), every=1)
    rows = np.array(FakeRun(free, FakeWorld(free), 4000).rows)
    ended = FakeRun(plan, FakeWorld(plan), 4000)
    assert ended.summary is not None
    last = ended.summary.steps
    assert last % MONITORING_INTERVAL == 0
    assert ended.summary.stopped is not None
    assert ended.summary.stopped.reason == "all has been at rest for 0.6 s"
    moving = np.flatnonzero(np.abs(rows[: last + 1, 2]) > 0.5)[-1]
    assert 600 <= last - moving <= 600 + 2 * MONITORING_INTERVAL
    # up to there nothing has changed, and the last row is there
    assert ended.rows[-1] == rows[last].tolist()


def test_rest_before_a_time_does_not_count() -> None:
    one = {"actuation": [], "initial_angles": [0.1]}  # where the spring is at rest
    for after, last in ((0, 504), (0.3, 808)):
        plan = hinges({"at_rest": {"after": after}}, one=one)
        ended = FakeRun(plan, FakeWorld(plan), 4000)
        assert ended.summary is not None
        assert ended.summary.steps == last


@pytest.mark.parametrize("scale", [1, 20])
@pytest.mark.parametrize("every", [1, 10, 1000])
def test_a_cube_falls_out_of_its_box(every: int, scale: int) -> None:
    pytest.importorskip("pybullet")
    data = scene_of_objects({**CUBE, "position": [0, 0, 1]}, world_scale=scale)
    data |= {"stop": [{"time": 3}, {"object": "cube", "leaves": {"z": [0.5, 2]}}]}
    data["record"] = {"every": every, "columns": []}
    rows, summary = simulated(scene_from_text(json.dumps(data)), 5000)
    fallen = np.sqrt(2 * 0.5 / G) * 1000
    assert fallen <= summary.steps <= fallen + MONITORING_INTERVAL
    height = 1 - G * (summary.steps * 1e-3) ** 2 / 2
    assert rows[-1][3] == pytest.approx(height, abs=1e-9)
    assert summary.stopped is not None
    assert summary.stopped.condition == 1
    assert summary.stopped.reason == f"'cube' has left z in [0.5, 2]: it is at {height:.6g} m"


def test_a_cube_slides_until_it_rests() -> None:
    pytest.importorskip("pybullet")
    data = scene_of_objects({**CUBE, "linear_velocity": [0.5, 0, 0]}, ground={}, gravity=[0, 0, -G])
    data |= {"stop": [{"at_rest": {"for": 0.1}}]}
    del data["manipulators"][0]["position"]  # hanging is no rest; this one stands
    data["manipulators"][0]["position"] = [9, 9, 9]
    rows, summary = simulated(scene_from_text(json.dumps(data)), 3000)
    slides_for = 0.5 / (0.5 * G) * 1000
    assert summary.stopped is not None
    assert slides_for + 100 <= summary.steps < 3000
    assert rows[-1][1] == pytest.approx(0.25 / (2 * 0.5 * G), rel=1e-3)


def test_a_plan_without_conditions_reads_no_state() -> None:
    plan = make_plan(scene_from_text(json.dumps(scene_of_objects(CUBE))))
    assert (plan.stop_conditions, plan.records_last_step) == ((), False)
