"""The arm that plays with a ball in short: what is read from its runs, and that it scores."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.simulation.engine.bullet import collision_filter
from somo_cli.simulation.run import RunSummary
from tests.studies import ball_arm
from tests.studies.ball_arm import apart, is_in, table_of_runs
from tests.studies.running import Record, Setting, recorded


def record_of(ball: list[list[float]], tip: list[list[float]]) -> Record:
    columns = {"time_s": np.arange(len(ball), dtype=float)}
    for name, places in (("ball.pose", ball), ("ball_arm.tip", tip)):
        for axis, values in zip("xyz", np.array(places).T, strict=True):
            columns[f"{name}.{axis}_m"] = values
    return Record(columns, RunSummary(1, 2, 1.0))


TIP = [[0.0, 0.0, 7.8], [-6.0, 0.0, 0.2]]
IN = record_of([[3.5, 0.75, 0.495], [-3.0, 0.0, 0.495]], TIP)


def test_in_is_behind_the_line_and_on_the_ground() -> None:
    assert is_in(IN)
    assert not is_in(record_of([[3.5, 0.75, 0.495], [-2.4, 0.0, 0.495]], TIP))
    assert not is_in(record_of([[3.5, 0.75, 0.495], [-3.0, 0.0, 1.5]], TIP))


def test_the_largest_and_the_last_distance_of_two_runs() -> None:
    other = record_of([[3.5, 0.75, 1.495], [-3.0, 0.4, 0.795]], TIP)
    assert apart(IN, other, "ball.pose") == (pytest.approx(1.0), pytest.approx(0.5))
    assert apart(IN, other, "ball_arm.tip") == (0, 0)
    assert table_of_runs([("other", other)], IN)[1].split() == (
        ["other", "-3.000", "0.400", "0.795", "out", "1.000", "0.500", "0.000", "0.000"]
    )


@pytest.mark.slow
def test_the_loop_that_users_write_lays_the_arm_down_as_ours_does() -> None:
    pytest.importorskip("pybullet")
    ours = recorded(Setting(ball_arm.SCENE, 2.0, (), 2e-3))
    wall, ball = ball_arm.classic(0.2)
    assert wall > 0
    assert ball == pytest.approx((3.5, 0.75, 0.495), abs=1e-4)
    assert ours["ball.pose.x_m"][-1] == pytest.approx(3.5)
    # the torques have begun to bend it towards the ball
    assert ours["ball_arm.tip.x_m"][-1] > 1
    assert abs(ours["ball_arm.tip.y_m"][-1]) < 1e-6


@pytest.mark.slow
def test_the_arm_takes_the_ball_behind_the_goal_line_at_two_milliseconds() -> None:
    pytest.importorskip("pybullet")
    record = recorded(ball_arm.setting(2e-3))
    assert is_in(record)
    heights = record["ball.pose.z_m"]
    assert heights.max() > 3  # carried, not rolled


@pytest.mark.slow
def test_neither_more_iterations_nor_half_the_step_move_the_tip_by_one_per_cent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("pybullet")
    lying = dataclasses.replace(ball_arm.setting(2e-3), seconds=8.0)
    few = recorded(lying)
    finer = recorded(dataclasses.replace(lying, time_step=1e-3))
    monkeypatch.setattr(collision_filter, "CROWD_ITERATIONS", 200)
    many = recorded(lying)
    by_solver, by_step = (apart(other, few, "ball_arm.tip")[0] for other in (many, finer))
    # of an arm of 7.8 m: 38 mm by 200 iterations in place of 50 (10 mm by 100, 48 mm by 400), 25 mm
    # by the step: where much touches, the solver is the larger error of the two
    assert 0 < by_solver < 0.045
    assert 0 < by_step < 0.027
