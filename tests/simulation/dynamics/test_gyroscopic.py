"""The midpoint rule of rotation: what it keeps, whatever the body and the step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.simulation.dynamics.gyroscopic import (
    MAX_EXACT_ANGLE,
    gyroscopic_acceleration,
    half_turned,
    mean_rates,
    midpoint_rate,
    rate_half_step_before,
)
from tests.free_bodies.truth import rotation_of

STEP = 1e-3  # s
MOMENTS = [(7.5e-4, 7.5e-4, 5e-6), (1.0, 2.0, 2.9), (1.0, 0.5, 0.51), (1.0, 1.0, 1.99)]


@pytest.mark.parametrize("sign", [1, -1])
def test_half_a_step_turns_axes_by_half_the_angle(sign: int) -> None:
    rate, vector = (3.0, -50.0, 400.0), (0.3, 0.2, -0.7)
    turned = rotation_of(-sign * 0.5 * STEP * np.array(rate)) @ vector
    assert half_turned(vector, rate, sign * STEP) == pytest.approx(turned, rel=1e-13)
    back = half_turned(half_turned(vector, rate, STEP), rate, -STEP)
    assert back == pytest.approx(vector, rel=1e-14)
    assert half_turned(vector, (0.0, 0.0, 0.0), STEP) == vector


def test_the_engine_turns_by_less_than_the_angle_of_a_large_step() -> None:
    # seen in the engine: 1 rad in a step comes out as 0.9706423 rad
    x, y, _ = half_turned((1.0, 0.0, 0.0), (0.0, 0.0, 1 / STEP), STEP)
    assert 2 * math.atan2(-y, x) == pytest.approx(0.9706423306, rel=1e-9)
    below, above = (
        half_turned((1.0, 0.0, 0.0), (0.0, 0.0, MAX_EXACT_ANGLE * (1 + e) / STEP), STEP)
        for e in (-1e-9, 1e-9)
    )
    assert above == pytest.approx(below, abs=1e-8)


@pytest.mark.parametrize("moments", MOMENTS)
@pytest.mark.parametrize("angle", [1e-3, 0.1, 0.5, 1.0])
def test_the_rate_keeps_the_momentum(moments: tuple[float, float, float], angle: float) -> None:
    rate = tuple((np.array([0.3, 0.4, 0.87]) * angle / STEP).tolist())
    momentum = tuple(a * b for a, b in zip(moments, rate, strict=True))
    found = midpoint_rate(moments, momentum, rate, STEP)
    assert found is not None
    assert np.array(moments) * found == pytest.approx(
        half_turned(momentum, found, STEP), abs=1e-11 * np.linalg.norm(momentum)
    )
    # and the step before it is the step back
    before = midpoint_rate(moments, momentum, rate, -STEP)
    assert before is not None
    own = tuple((np.array(moments) * before).tolist())
    assert half_turned(own, before, STEP) == pytest.approx(
        momentum, abs=1e-11 * np.linalg.norm(momentum)
    )


def test_there_is_no_rate_for_steps_too_large() -> None:
    moments, rate = (1.0, 2.0, 2.9), (900.0, 1200.0, 2610.0)
    momentum = (900.0, 2400.0, 7569.0)
    assert midpoint_rate(moments, momentum, rate, STEP) is None


def test_the_gyroscopic_acceleration_is_that_of_euler() -> None:
    moments, rate = np.array([1.0, 2.0, 2.5]), np.array([0.5, 15.0, 0.3])
    expected = np.cross(rate, moments * rate) / moments
    found = gyroscopic_acceleration((1.0, 2.0, 2.5), (0.5, 15.0, 0.3))
    assert found == pytest.approx(expected, rel=1e-15)


def test_half_a_step_before_the_start_contacts_have_acted_by_half() -> None:
    moments, rate, torque = (1.0, 2.0, 2.5), (0.5, 1.5, 0.3), np.array([7.0, -3.0, 4.0])
    gyroscopic = np.array(gyroscopic_acceleration(moments, rate))
    after = np.array(rate) + STEP * (torque / moments - gyroscopic)
    found = rate_half_step_before(moments, rate, tuple(after.tolist()), STEP)
    expected = np.array(rate) - 0.5 * STEP * (torque / moments - gyroscopic)
    assert found == pytest.approx(expected, abs=3 * STEP**2)


def test_the_rate_of_a_row_is_that_of_the_mean_momentum() -> None:
    moments = (1.0, 2.0, 2.9)
    turned = rotation_of(np.array([0.3, -0.8, 0.5]))
    rate = np.array([30.0, -20.0, 60.0])
    momentum = tuple((np.array(moments) * rate).tolist())
    pair = [midpoint_rate(moments, momentum, tuple(rate.tolist()), s * STEP) for s in (-1, 1)]
    before, after = (turned @ np.array(one) for one in pair)
    found = mean_rates(moments, turned[np.newaxis], before[np.newaxis], after[np.newaxis], STEP)
    assert found[0] == pytest.approx(turned @ rate, rel=1e-11)
    assert 0.5 * (before + after) != pytest.approx(turned @ rate, rel=1e-5)
