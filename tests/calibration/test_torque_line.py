"""Straight lines through measured points, against numpy and by counting how often they hold."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.calibration.torque_line import line

PRESSURES = np.array([2e4, 4e4, 6e4, 8e4, 1e5])


def test_points_on_a_line() -> None:
    found = line(PRESSURES, 5e-7 * PRESSURES - 0.002, False)
    assert found.per_pressure == pytest.approx(5e-7)
    assert found.offset == pytest.approx(-0.002)
    assert found.has_offset
    assert found.residual == pytest.approx(0, abs=1e-15)
    through = line(PRESSURES, 5e-7 * PRESSURES, True)
    assert (through.per_pressure, through.offset) == (pytest.approx(5e-7), 0)
    assert not through.has_offset


def test_the_line_is_that_of_least_squares() -> None:
    torques = 5e-7 * PRESSURES + 0.001 * np.array([1, -2, 0, 3, -1])
    found = line(PRESSURES, torques, False)
    assert (found.per_pressure, found.offset) == pytest.approx(
        tuple(np.polyfit(PRESSURES, torques, 1))
    )
    assert found.residuals == pytest.approx(torques - found.per_pressure * PRESSURES - found.offset)
    zero = line(PRESSURES, torques, True)
    (slope,), *_ = np.linalg.lstsq(PRESSURES[:, np.newaxis], torques, rcond=None)
    assert zero.per_pressure == pytest.approx(slope)


@pytest.mark.parametrize("through_zero", [False, True])
def test_the_intervals_hold_the_truth_as_often_as_they_say(through_zero: bool) -> None:
    random = np.random.default_rng(5)
    hits = [0, 0]
    for _ in range(400):
        torques = 5e-7 * PRESSURES + 0.001 * random.standard_normal(len(PRESSURES))
        found = line(PRESSURES, torques, through_zero)
        hits[0] += abs(found.per_pressure - 5e-7) < found.per_pressure_error
        hits[1] += not found.has_offset
    assert 0.92 * 400 < hits[0] < 0.98 * 400
    assert hits[1] > 0.92 * 400


def test_without_freedom_nothing_is_known_of_the_error() -> None:
    assert line(np.array([1e5]), np.array([0.05]), True).per_pressure == pytest.approx(5e-7)
    assert not math.isfinite(line(np.array([1e5]), np.array([0.05]), True).per_pressure_error)
    two = line(np.array([1e4, 1e5]), np.array([0.01, 0.05]), False)
    assert not math.isfinite(two.per_pressure_error)
    assert not two.has_offset
