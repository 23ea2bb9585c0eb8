"""Where a function leaves its variables as they are, however steep it is."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.arrays import Array
from somo_cli.simulation.integrator.fixed_point import fixed_point

STEEP = np.array([[0.1, 3.0, 0.0], [-3.0, -2.0, 0.5], [0.2, 0.0, 0.3]])
SHIFT = np.array([1.0, -2.0, 0.5])


def test_a_steep_linear_function_needs_twice_as_many_rounds_as_it_has_variables() -> None:
    calls: list[Array] = []

    def function(x: Array) -> Array:
        calls.append(x)
        return STEEP @ x + SHIFT

    found = fixed_point(function, np.zeros(3), 1e-10, 30)
    assert found == pytest.approx(np.linalg.solve(np.eye(3) - STEEP, SHIFT), abs=1e-9)
    assert len(calls) <= 8
    assert calls[-1] is found


def test_what_starts_at_the_solution_stays_there() -> None:
    assert fixed_point(np.sqrt, np.ones(2), 1e-12, 5) == pytest.approx(np.ones(2))


def test_a_nonlinear_function_is_solved() -> None:
    found = fixed_point(lambda x: np.cos(x) + 0.2 * x[::-1] ** 2, np.zeros(2), 1e-12, 30)
    assert found is not None
    assert np.cos(found) + 0.2 * found[::-1] ** 2 == pytest.approx(found, abs=1e-11)


def test_without_a_solution_it_ends() -> None:
    calls = 0

    def function(x: Array) -> Array:
        nonlocal calls
        calls += 1
        return x + 1 + x**2

    assert fixed_point(function, np.zeros(1), 1e-12, 10) is None
    assert calls <= 11
    assert fixed_point(lambda x: x + np.nan, np.ones(1), 1e-12, 10) is None
    assert fixed_point(lambda x: x + 1e200, np.ones(1), 1e-12, 10) is None
