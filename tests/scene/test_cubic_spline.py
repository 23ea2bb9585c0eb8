"""Slopes of splines against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from somo_cli.scene.cubic_spline import clamped_slopes, periodic_slopes


def points(count: int, spread: float, seed: int) -> tuple[list[float], list[float]]:
    """Return times, neighbouring intervals of which differ by up to `spread`, and values."""
    random = np.random.default_rng(seed)
    times = np.cumsum(spread ** random.uniform(-0.5, 0.5, count))
    return times.tolist(), random.normal(size=count).tolist()


def assert_equal(found: list[float], spline: CubicSpline, times: list[float]) -> None:
    expected = spline(times, 1)
    assert np.abs(np.array(found) - expected).max() <= 1e-11 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize("spread", [1.0, 10.0, 1e4])
@pytest.mark.parametrize("count", [2, 3, 4, 5, 50, 2000])
def test_clamped(count: int, spread: float) -> None:
    times, values = points(count, spread, count)
    found = clamped_slopes(times, values)
    assert found[0] == found[-1] == 0
    assert_equal(found, CubicSpline(times, values, bc_type="clamped"), times)


@pytest.mark.parametrize("spread", [1.0, 10.0, 1e4])
@pytest.mark.parametrize("count", [2, 3, 4, 5, 50, 2000])
def test_periodic(count: int, spread: float) -> None:
    times, values = points(count, spread, count)
    values[-1] = values[0]
    found = periodic_slopes(times, values)
    assert found[0] == found[-1]
    assert_equal(found, CubicSpline(times, values, bc_type="periodic"), times)
