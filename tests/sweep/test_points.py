"""The parameter sets of a study."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.sweep.expressions import ExpressionError, parse_expression
from somo_cli.sweep.points import combined, number_of_points, spaced
from somo_cli.sweep.study import Parameter

A = Parameter("a", (), "values", (1, 2))
B = Parameter("b", (), "values", (10.0, 20.0, 30.0))
SUM = Parameter("sum", (), "expression", expression=parse_expression("a + b"))
TWICE = Parameter("twice", (), "expression", expression=parse_expression("2 * sum"))


def test_a_grid_varies_the_last_parameter_fastest() -> None:
    sets = combined([A, B], "grid")
    assert [(one["a"], one["b"]) for one in sets] == [
        *((1, 10.0), (1, 20.0), (1, 30.0), (2, 10.0), (2, 20.0), (2, 30.0))
    ]
    assert len(sets) == number_of_points([A, B], "grid", None)


def test_slices_go_through_the_first_values() -> None:
    sets = combined([A, B], "slices")
    assert [(one["a"], one["b"]) for one in sets] == [(1, 10.0), (2, 10.0), (1, 20.0), (1, 30.0)]
    assert len(sets) == number_of_points([A, B], "slices", None)


def test_expressions_follow_in_any_order() -> None:
    found = combined([TWICE, A, SUM, B], "grid")
    assert list(found[0]) == ["twice", "a", "sum", "b"]
    assert found[0] == {"twice": 22.0, "a": 1, "sum": 11.0, "b": 10.0}
    loop = Parameter("sum", (), "expression", expression=parse_expression("twice"))
    with pytest.raises(ExpressionError, match="depends on itself"):
        combined([TWICE, loop], "grid")


def test_whole_values_of_expressions_are_integers() -> None:
    """A number of segments may be an expression: 20 - distal."""
    rest = Parameter("rest", (), "expression", expression=parse_expression("20 - a"))
    half = Parameter("half", (), "expression", expression=parse_expression("a / 2"))
    near = Parameter("near", (), "expression", expression=parse_expression("round(a / 3)"))
    first, second = combined([A, rest, half, near], "grid")
    assert repr(first) == "{'a': 1, 'rest': 19, 'half': 0.5, 'near': 0}"
    assert repr(second) == "{'a': 2, 'rest': 18, 'half': 1, 'near': 1}"


def test_spacing_has_exact_ends() -> None:
    assert spaced(0.034, 0.046, 4, False) == (0.034, 0.038, 0.042, 0.046)
    assert spaced(3e4, 6e4, 4, False) == (3e4, 4e4, 5e4, 6e4)
    assert spaced(1.0, 100.0, 3, True) == (1.0, pytest.approx(10.0), 100.0)
    assert spaced(-1.0, -100.0, 3, True)[1] == pytest.approx(-10.0)
    assert spaced(5.0, 9.0, 1, False) == (5.0,)


def test_a_latin_hypercube_has_each_part_of_a_range_once() -> None:
    ranges = [
        Parameter("x", (), "random", bounds=(0.0, 1.0)),
        Parameter("y", (), "random", bounds=(1.0, 1e4), is_log=True),
    ]
    sets = combined(ranges, "latin_hypercube", 50, seed=3)
    x = np.array([one["x"] for one in sets])
    y = np.log10([one["y"] for one in sets]) / 4
    for shares in (x, y):
        assert sorted(np.floor(50 * shares)) == list(range(50))
    assert abs(np.corrcoef(x, y)[0, 1]) < 0.5
    assert combined(ranges, "latin_hypercube", 50, seed=3) == sets
    assert combined(ranges, "latin_hypercube", 50, seed=4) != sets
    plain = combined([*ranges, B], "random", 200, seed=1)
    assert {one["b"] for one in plain} == set(B.values)


def test_sobol_points_are_balanced_and_repeat_by_their_seed() -> None:
    ranges = [Parameter(name, (), "random", bounds=(0.0, 1.0)) for name in "xyz"]
    sets = combined(ranges, "sobol", 64, seed=3)
    values = np.array([[one[name] for name in "xyz"] for one in sets])
    for column in values.T:  # each of 64 equal parts has one point
        assert sorted(np.floor(64 * column)) == list(range(64))
    quarters = np.floor(2 * values[:, :2]) @ (2, 1)
    assert np.bincount(quarters.astype(int)).tolist() == [16] * 4
    assert combined(ranges, "sobol", 64, seed=3) == sets
    assert combined(ranges, "sobol", 64, seed=4) != sets
    assert combined(ranges, "sobol", 40, seed=3) == sets[:40]
