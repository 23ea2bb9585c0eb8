"""The closed forms against published tables, limits and integration."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from somo_cli.analysis import closed_forms

# Mattiasson, Int. J. Numer. Meth. Eng. 17 (1981) 145, table 1: load, w/L sideways, u/L shortening
MATTIASSON = [
    (0.2, 0.06636, 0.00265),
    (1, 0.30172, 0.05643),
    (2, 0.49346, 0.16064),
    (3, 0.60325, 0.25442),
    (4, 0.66996, 0.32894),
    (5, 0.71379, 0.38763),
    (6, 0.74457, 0.43459),
    (7, 0.76737, 0.47293),
    (8, 0.78498, 0.50483),
    (9, 0.79906, 0.53182),
    (10, 0.81061, 0.55500),
]


@pytest.mark.parametrize(("load", "sideways", "shortening"), MATTIASSON)
def test_the_elastica_is_that_of_the_table(load: float, sideways: float, shortening: float) -> None:
    x, y = closed_forms.tip_load(load)
    assert y == pytest.approx(sideways, abs=5.1e-6)
    assert 1 - x == pytest.approx(shortening, abs=5.1e-6)
    assert closed_forms.tip_load(-load) == (x, -y)


def test_small_loads_bend_a_beam_by_a_third() -> None:
    for load in (1e-3, 1e-2):
        x, y = closed_forms.tip_load(load)
        linear = closed_forms.small_tip_load(load)
        assert math.hypot(x - linear[0], y - linear[1]) < load**2 / 10
    assert closed_forms.own_weight(1e-4)[1] == pytest.approx(1e-4 / 8, rel=1e-7)


# Computed by shooting with DOP853 at 1e-13 and given to 12 digits; small loads are load/8
@pytest.mark.parametrize(
    ("load", "x", "y"),
    [
        (0.1, 0.999910732224, 0.012498437848),
        (1, 0.991246395347, 0.123471401983),
        (5, 0.846657179954, 0.495905044622),
        (20, 0.445232052240, 0.829881443439),
    ],
)
def test_a_beam_under_its_own_weight(load: float, x: float, y: float) -> None:
    assert closed_forms.own_weight(load) == pytest.approx((x, y), abs=1e-11)
    assert closed_forms.own_weight(-load) == pytest.approx((x, -y), abs=1e-11)


def test_an_end_moment_rolls_a_beam_to_a_circle() -> None:
    assert closed_forms.end_moment(0.0) == (1.0, 0.0)
    assert closed_forms.end_moment(math.pi / 2) == pytest.approx((2 / math.pi, 2 / math.pi))
    assert closed_forms.end_moment(2 * math.pi) == pytest.approx((0, 0), abs=1e-15)
    assert closed_forms.end_moment(-1.0) == pytest.approx((math.sin(1), math.cos(1) - 1))


@pytest.mark.parametrize(
    ("angle", "rate"), [(0.1, 0.0), (2.0, 0.0), (-1.0, 2.0), (1.0, -2.0), (0.0, 0.0), (0.5, 3.0)]
)
def test_a_pendulum_moves_as_its_equation_says(angle: float, rate: float) -> None:
    times = np.linspace(0, 5, 21)
    found = closed_forms.pendulum(times, 2.0, angle, rate)
    exact = solve_ivp(
        lambda t, y: [y[1], -4 * math.sin(y[0])],
        (0, 5), [angle, rate], method="DOP853", t_eval=times, rtol=1e-13, atol=1e-14,
    )  # fmt: skip
    assert found == pytest.approx(exact.y[0], abs=1e-10)


def test_the_period_of_a_pendulum_grows_with_its_swing() -> None:
    period = 4 * float(ellipk(math.sin(1.0) ** 2)) / 2.0
    found = closed_forms.pendulum(np.array([period / 4, period / 2, period]), 2.0, 2.0, 0.0)
    assert found == pytest.approx([0, -2, 2], abs=1e-6)
    with pytest.raises(ValueError, match="over the top"):
        closed_forms.pendulum(np.zeros(1), 2.0, 1.0, 10.0)


@pytest.mark.parametrize("damping", [0.0, 0.5, 2 * math.sqrt(0.35 * 50), 50.0])
def test_an_oscillator_moves_as_its_equation_says(damping: float) -> None:
    times = np.linspace(0, 2, 9)
    found = closed_forms.oscillator(times, 0.35, damping, 50.0, (0.3, -1.0))
    exact = solve_ivp(
        lambda t, y: [y[1], (-damping * y[1] - 50 * y[0]) / 0.35],
        (0, 2), [0.3, -1.0], method="DOP853", t_eval=times, rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    assert found == pytest.approx(exact.y[0], abs=1e-9)
