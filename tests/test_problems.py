from __future__ import annotations

import pickle

import pytest

from somo_cli.problems import (
    InvalidFile,
    Problem,
    SimulationDiverged,
    Span,
    did_you_mean,
    in_reading_order,
)


def at(source: str, line: int, column: int = 1, message: str = "bad") -> Problem:
    return Problem(Span(source, line, column), message)


def test_reading_order_is_by_source_line_and_column() -> None:
    problems = [at("b", 2), at("a", 3), at("b", 1, 9), at("b", 1, 2), at("a", 1)]
    assert in_reading_order(problems) == (
        at("b", 1, 2),
        at("b", 1, 9),
        at("b", 2),
        at("a", 1),
        at("a", 3),
    )


def test_sources_that_are_given_come_first_in_their_order() -> None:
    problems = [at("x", 1), at("b", 1), at("a", 1)]
    assert in_reading_order(problems, ["a", "none", "b"]) == (at("a", 1), at("b", 1), at("x", 1))


def test_problems_at_one_place_keep_their_order_and_are_said_once() -> None:
    problems = [at("a", 1, 1, "z"), at("a", 1, 1, "a"), at("a", 1, 1, "z")]
    assert in_reading_order(problems) == (at("a", 1, 1, "z"), at("a", 1, 1, "a"))


def test_an_invalid_file_orders_its_problems_as_its_texts() -> None:
    error = InvalidFile([at("part", 1), at("whole", 5)], {"whole": "", "part": ""})
    assert error.problems == (at("whole", 5), at("part", 1))
    assert str(error) == "whole:5:1: error: bad\npart:1:1: error: bad"


def test_errors_travel_between_processes() -> None:
    for error in (
        InvalidFile([at("a", 1)], {"a": "x"}),
        SimulationDiverged(3, 0.003, "arm.joint", "too fast", "go slow"),
    ):
        assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize(
    ("name", "known", "hint"),
    [
        ("force_n", ["force_mn", "time_s"], ""),
        ("force_n", ["forse_n", "force_mn"], "did you mean 'forse_n'?"),
        ("pressure_pa", ["pressure_kpa"], ""),
        ("ball.velocity.x_m_per_s", ["ball.velocity.x_rad_per_s"], ""),
        ("a.velocty.x_m_per_s", ["a.velocity.x_m_per_s"], "did you mean 'a.velocity.x_m_per_s'?"),
        ("pose.z_m", ["pose.qz", "poze.z_m"], "did you mean 'poze.z_m'?"),
        ("torque_per_presure", ["torque_per_pressure"], "did you mean 'torque_per_pressure'?"),
        ("tip_positon", ["tip_position"], "did you mean 'tip_position'?"),
    ],
)  # fmt: skip
def test_no_hint_proposes_another_unit(name: str, known: list[str], hint: str) -> None:
    assert did_you_mean(name, known) == hint
