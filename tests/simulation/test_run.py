"""The loop around a world of a few lines: which rows, when, and what ends it."""

from __future__ import annotations

import errno
import itertools
import json
import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from somo_cli.arrays import Array
from somo_cli.problems import EngineRefused
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import RunSummary, run
from tests.builders.fake_run import FakeRun
from tests.builders.fake_world import FakeWorld, plan_of_hinges
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

INTEGRATORS = ("implicit", "euler", "explicit")
STEPS_AT_START = {"implicit": 2, "euler": 1, "explicit": 0}  # steps that are undone before the run


def plan_that_records_hinges(
    columns: Iterable[str] = ("joint_angles",), every: int = 1, **more: Any
) -> Plan:
    return plan_of_hinges(record={"every": every, "columns": list(columns)}, **more)


# steps of the run, and steps from row to row; motion is checked every eighth step
ROWS = {
    "the start alone": (0, 1),
    "every step, within one interval of checks": (6, 1),
    "every step, to a check": (8, 1),
    "every step, over several checks": (33, 1),
    "the last row is before the last step": (20, 3),
    "the last step has a row": (21, 7),
    "the last step is a check and has no row": (8, 7),
    "every row is at a check": (32, 8),
    "the only row is the start": (63, 64),
}


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("columns", ["joint_angles", "joint_rates"])
@pytest.mark.parametrize(("steps", "every"), ROWS.values(), ids=ROWS)
def test_every_recorded_step_has_one_row_and_progress_grows_to_the_end(
    integrator: str, columns: str, steps: int, every: int
) -> None:
    """Also where rates need half a step beyond the row, as those of the implicit integrator do."""
    plan = plan_that_records_hinges([columns], every, integrator=integrator)
    ended = FakeRun(plan, FakeWorld(plan), steps)
    expected = [every * row / 1000 for row in range(steps // every + 1)]
    assert ended.times == pytest.approx(expected, rel=1e-12)
    assert ended.summary == RunSummary(steps, steps // every + 1, 2.5)
    assert ended.reported[0] == 0
    assert ended.reported[-1] == steps
    assert ended.reported == sorted(set(ended.reported))


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_what_is_recorded_does_not_depend_on_how_often(integrator: str) -> None:
    plans = [
        plan_that_records_hinges(["joint_angles"], every, integrator=integrator, time_step=0.02)
        for every in (1, 5, 40)
    ]
    rows = [FakeRun(plan, FakeWorld(plan), 40).rows for plan in plans]
    assert np.allclose(rows[1], rows[0][::5], rtol=0, atol=1e-12)
    assert np.allclose(rows[2], rows[0][::40], rtol=0, atol=1e-12)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_nothing_but_the_start(integrator: str) -> None:
    start = {"initial_angles": [0.2], "initial_rates": [-3.0]}
    plan = plan_that_records_hinges(
        ["joint_angles", "joint_rates", "actuation"], one=start, integrator=integrator
    )
    ended = FakeRun(plan, FakeWorld(plan, load=2.0), 0)
    # the implicit law recovers the rate of the start to the second order of the step
    error = 1e-6 if integrator == "implicit" else 0.0
    assert np.allclose(ended.rows, [[0.0, 0.2, -3.0, 1.0]], rtol=0, atol=error)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("columns", [["joint_angles"], ["joint_angles", "joint_rates"]])
def test_the_world_is_stepped_as_often_as_asked(integrator: str, columns: list[str]) -> None:
    """But for the start, and for one step whose rates complete the last row's."""
    plan = plan_that_records_hinges(columns, 10, integrator=integrator)
    for steps in (10, 25):
        world = FakeWorld(plan)
        FakeRun(plan, world, steps)
        completes = integrator == "implicit" and "joint_rates" in columns and steps == 10
        assert world.steps == STEPS_AT_START[integrator] + steps + completes


def test_implicit_rates_are_means_of_two_half_steps() -> None:
    for every in (1, 4):
        plan = plan_that_records_hinges(
            ["joint_rates"], every, one={"initial_rates": 1.0}, time_step=0.01
        )
        world = FakeWorld(plan, load=0.5)
        rows = FakeRun(plan, world, 20).rows
        halves = np.array(world.rates)[STEPS_AT_START["implicit"] :, 0]
        means = (halves[1:] + halves[:-1]) / 2  # at steps 1, 2, ...
        assert rows[0][1] == pytest.approx(1.0, abs=1e-3)
        assert [row[1] for row in rows[1:]] == pytest.approx(list(means[every - 1 :: every]))


@pytest.mark.parametrize("integrator", ["euler", "explicit"])
def test_other_rates_are_those_of_the_world(integrator: str) -> None:
    one = {"initial_rates": 1.0}
    plan = plan_that_records_hinges(["joint_rates"], one=one, integrator=integrator, time_step=0.01)
    world = FakeWorld(plan, load=0.5)
    rows = FakeRun(plan, world, 20).rows
    after = np.array(world.rates)[STEPS_AT_START[integrator] :, 0]
    assert [row[1] for row in rows] == [1.0, *after]


def test_a_row_holds_the_state_of_its_time() -> None:
    columns = ["joint_angles", "spring_torques", "actuation"]
    one = {
        "actuation": [{"actuator": 0, "axis": 0, "waypoints": [[0, 0], [0.5, 5]]}],
        "initial_angles": 0.3,
    }
    plan = plan_that_records_hinges(columns, 5, one=one, time_step=0.01)
    rows = np.array(FakeRun(plan, FakeWorld(plan), 60).rows)
    assert np.allclose(rows[:, 2], -20.0 * (rows[:, 1] - 0.1), rtol=0, atol=1e-12)
    assert np.allclose(rows[:, 3], np.minimum(10 * rows[:, 0], 5.0), rtol=0, atol=1e-12)


def test_every_torque_change_acts_between_two_checks() -> None:
    """A pulse of a single step does its work, wherever it falls."""
    for at in range(1, 40):
        time = at * 0.001
        points = [[0, 0], [time - 0.0005, 1], [time + 0.0005, 0]]
        drive = {"actuator": 0, "axis": 0, "waypoints": points, "interpolation": "step"}
        one = {"actuation": [drive], "initial_angles": 0.1}
        plan = plan_that_records_hinges(["joint_angles"], 100, one=one, integrator="explicit")
        world = FakeWorld(plan)
        FakeRun(plan, world, 50)
        rates = np.array(world.rates)[:, 0]
        assert rates[:at] == pytest.approx(0, abs=1e-15)
        assert rates[at] == pytest.approx(0.001 * 1.0 / 0.5)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("rate", [1e9, -1e9, math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("at", [1, 5, 30])
def test_a_run_that_diverges_stops(integrator: str, rate: float, at: int) -> None:
    plan = plan_that_records_hinges(["joint_angles", "joint_rates"], integrator=integrator)
    world = FakeWorld(plan)
    joint = world.bodies[0]

    def kick() -> None:
        joint.rates = np.array([rate])

    world.at_step[STEPS_AT_START[integrator] + at] = kick
    ended = FakeRun(plan, world, 100)
    assert ended.error is not None
    assert (ended.error.step, ended.error.name) == (at, "a.actuator_0_joint_01")
    assert ended.error.time == pytest.approx(0.001 * at)
    # the rows before it, each once
    assert ended.times == pytest.approx([row / 1000 for row in range(at)], rel=1e-12)


def test_divergence_between_rows_is_noticed_soon() -> None:
    plan = plan_that_records_hinges(["joint_angles"], every=1000)
    world = FakeWorld(plan)

    def kick() -> None:
        world.bodies[0].rates = np.array([1e9])

    world.at_step[STEPS_AT_START["implicit"] + 100] = kick
    ended = FakeRun(plan, world, 5000)
    assert ended.error is not None
    assert 100 <= ended.error.step <= 120
    assert ended.times == [0.0]


def test_bodies_come_in_the_order_of_the_plan() -> None:
    names = ["c", "a", "b"]
    plan = plan_that_records_hinges(["joint_angles"], names=names)
    world = FakeWorld(plan)
    for body, angle in zip(world.bodies, (0.1, 0.2, 0.3), strict=True):
        body.reset([angle], [0.0])
    # the state at the start is the world's, whatever the plan says
    plan_explicit = plan_that_records_hinges(["joint_angles"], names=names, integrator="explicit")
    assert FakeRun(plan_explicit, world, 0).rows == [[0.0, 0.1, 0.2, 0.3]]


def test_an_error_of_the_writer_ends_the_run() -> None:
    plan = plan_that_records_hinges()
    world = FakeWorld(plan)
    blocks: list[Array] = []

    def write(block: Array) -> None:
        blocks.append(block)
        if len(blocks) == 3:
            raise BrokenPipeError

    with pytest.raises(BrokenPipeError):
        run(plan, world, write, 10_000, lambda: 0.0)
    times = np.concatenate(blocks)[:, 0]
    assert times == pytest.approx(0.001 * np.arange(len(times)), rel=1e-12)
    assert world.steps < 1000


@pytest.mark.parametrize("error", [KeyboardInterrupt(), EngineRefused("a", "it is tired")])
def test_whatever_ends_a_run_its_rows_are_written(error: BaseException) -> None:
    plan = plan_that_records_hinges(["joint_angles", "joint_rates"])
    world = FakeWorld(plan)
    rows: list[list[float]] = []

    def end() -> None:
        raise error

    world.at_step[STEPS_AT_START["implicit"] + 300] = end
    with pytest.raises(type(error)):
        run(plan, world, lambda block: rows.extend(block.tolist()), 1000, lambda: 0.0)
    # the row of step 299 would have needed the step that failed
    assert [row[0] for row in rows] == pytest.approx(0.001 * np.arange(299), rel=1e-12)


def test_a_full_disk_does_not_hide_what_ended_the_run() -> None:
    plan = plan_that_records_hinges()
    world = FakeWorld(plan)

    def end() -> None:
        raise KeyboardInterrupt

    def write(block: Array) -> None:
        raise OSError(errno.ENOSPC, "no space left")

    world.at_step[STEPS_AT_START["implicit"] + 20] = end
    with pytest.raises(KeyboardInterrupt):
        run(plan, world, write, 1000, lambda: 0.0)
    with pytest.raises(OSError, match="no space left"):
        run(plan, FakeWorld(plan), write, 10, lambda: 0.0)


@pytest.mark.parametrize(("is_live", "most"), [(True, 8), (False, 300)])
def test_a_reader_need_not_wait(is_live: bool, most: int) -> None:
    """The clock advances a second whenever it is read; it is not read where nobody waits."""
    plan = plan_that_records_hinges()
    blocks: list[Array] = []
    clock = itertools.count(0.0, 1.0)
    run(plan, FakeWorld(plan), blocks.append, 2000, lambda: next(clock), is_live=is_live)
    times = np.concatenate(blocks)[:, 0]
    assert times == pytest.approx(0.001 * np.arange(2001), rel=1e-12)
    assert most - 50 < max(map(len, blocks)) <= most
    assert (next(clock) > 100) is is_live


TWO_FREE = {
    "manipulators": [
        {"definition": "finger.yaml", "initial_angles": 0.1, "base": "free", "name": name}
        for name in ("a", "b")
    ],
    "record": {"columns": ["joint_angles", "joint_rates", "base_pose", "tip_position"]},
}


def test_equal_runs_give_equal_rows_to_the_last_bit() -> None:
    # far apart, so that they do not touch
    plan = make_plan(scene_from_text(json.dumps(TWO_FREE), "manipulators[1].position=[1, 0, 0]"))
    assert rows_of(plan, 100) == rows_of(plan, 100)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_what_is_recorded_changes_nothing_of_the_motion(integrator: str) -> None:
    step = 1e-4 if integrator == "explicit" else 1e-3

    def angles(every: int, columns: str) -> dict[float, list[float]]:
        scene = scene_from_file(
            "scene.yaml",
            f"record={{every: {every}, columns: [{columns}]}}",
            f"integrator={integrator}",
            f"time_step={step}",
            "manipulators[0].initial_angles=0.1",
        )
        return {row[0]: row[1:11] for row in rows_of(scene, 150)}

    all_of_them = angles(1, "joint_angles")
    for every in (1, 3, 8, 50):
        for columns in ("joint_angles", "joint_angles, joint_rates"):
            found = angles(every, columns)
            assert len(found) == 150 // every + 1
            assert found == {time: all_of_them[time] for time in found}
