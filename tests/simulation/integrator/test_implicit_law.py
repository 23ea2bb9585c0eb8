"""The law is arithmetic: it is tested against the same formulas written plainly."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.arrays import Array, invert
from somo_cli.simulation.integrator.impacts import SMOOTH, limited_change
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.plan.joint_springs import JointSprings
from tests.builders.spring_laws import (
    H,
    inertia,
    plain_torques,
    spring_damper_torques,
    springs,
    torques_with_nothing_to_correct,
)


def random() -> np.random.Generator:
    """Return numbers that no other test can shift."""
    return np.random.default_rng(7)


def test_the_correction_acts_like_actuation_and_the_lag_of_the_bias_like_force() -> None:
    numbers = random()
    law, mass = SpringDamperLaw(springs(), H, "implicit"), inertia()
    law.refresh(mass)
    quadratic = numbers.normal(size=(3, 3, 3))

    def bias_at(rates: np.ndarray) -> np.ndarray:
        return quadratic @ rates @ rates

    v_prev = tau_prev = np.zeros(3)
    bias_prev = None
    for _ in range(3):
        q, v, u = numbers.normal(size=(3, 3))
        law.angles[:], law.rates[:], law.actuation[:] = q, v, u
        torques = law.correct(bias_at(v), bias_at)
        lag = np.zeros(3) if bias_prev is None else bias_prev - bias_at(v)
        first = plain_torques(law, mass, q, v, v_prev, tau_prev - lag, u)
        damping, b = law.coefficients.matrices(mass)
        # τ = s - B a, so a = B⁻¹ (s - τ); half a step of it leads to the rates of the instant
        s = u - law.springs.stiffness * (q - law.springs.neutral) - damping @ v
        coming = v + 0.5 * H * np.linalg.solve(b, s - first)
        change = bias_at(v) - bias_at(coming)
        whole = plain_torques(law, mass, q, v, v_prev, tau_prev - lag, u + change)
        assert torques == pytest.approx(whole)
        v_prev, tau_prev, bias_prev = v, np.array(torques), bias_at(v)


def test_a_singular_matrix_has_no_inverse_and_stops_nothing() -> None:
    with np.errstate(invalid="ignore"):
        singular, regular = invert(np.array([np.zeros((2, 2)), [[2.0, 1.0], [1.0, 1.0]]]))
    assert np.isnan(singular).all()
    assert regular == pytest.approx(np.array([[1.0, -1.0], [-1.0, 2.0]]))


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_at_rest_the_torque_is_the_spring_s(integrator: str) -> None:
    """Whatever the step: f balances s, so a is zero, and statics are exact."""
    law, mass = SpringDamperLaw(springs(), H, integrator), inertia()
    torques = torques_with_nothing_to_correct(law, mass)
    law.angles[:], law.actuation[:] = [0.3, -0.1, 0.5], [1.0, 2.0, -1.0]
    expected = law.actuation + spring_damper_torques(law.springs, law.angles, law.rates)
    law.set_force(-expected)
    assert torques() == pytest.approx(expected, rel=1e-12)
    assert law.acceleration(mass, -expected) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("stiffer", [1.0, 1e4, 1e8])
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_the_linear_chain_is_stable_however_stiff(integrator: str, stiffer: float) -> None:
    soft = springs()
    stiff = JointSprings(soft.stiffness * stiffer, soft.damping, soft.neutral)
    law, mass = SpringDamperLaw(stiff, H, integrator), inertia()
    torques = torques_with_nothing_to_correct(law, mass)
    angles, rates = np.array([0.3, -0.2, 0.1]), np.zeros(3)
    law.angles[:] = angles
    law.rates[:] = rates = (
        -0.5 * H * law.acceleration(mass, np.zeros(3)) * (integrator == "implicit")
    )
    law.set_force(np.zeros(3))
    largest = 0.0
    for _ in range(3000):
        law.angles[:], law.rates[:] = angles, rates
        rates = rates + H * np.linalg.solve(mass, torques())
        angles = angles + H * rates
        largest = max(largest, float(np.abs(angles).max()))
    assert largest < 2


def one_mode(x: float, y: float) -> tuple[float, float]:
    """Return (D + N) h/m and B/m of one mode with x = h d/m and y = h² k/m, in the implicit law."""
    stiffness, damping = np.array([y / H**2]), np.array([x / H])
    law = SpringDamperLaw(JointSprings(stiffness, damping, np.zeros(1)), H, "implicit")
    (damped,), (implicit,) = (part[0] for part in law.coefficients.matrices(np.eye(1)))
    return H * damped, implicit


def amplification(x: float, y: float) -> np.ndarray:
    """Return the two factors by which a mode changes in a step, without other forces."""
    damped, implicit = one_mode(x, y)
    p, q = (y + damped) / (1 + implicit), damped / (1 + implicit)
    return np.roots([1, p - 2, 1 - q])


SIZES = [0.0, *np.logspace(-4, 12, 65)]


@pytest.mark.moderate
def test_no_mode_grows_however_stiff_or_damped() -> None:
    for x in SIZES:
        for y in SIZES:
            assert np.abs(amplification(x, y)).max() <= 1 + 1e-12, (x, y)


def test_modes_that_the_step_does_not_resolve_die_and_do_not_flip() -> None:
    """Flipping in every step is what an old mass matrix would make grow."""
    for x in (0.0, 1.0, 1e3, 1e6):
        assert np.abs(amplification(x, 1e12)).max() < 2e-5 + 1e-3 * (x > 1e5), x
    for x in np.logspace(-2, 8, 41):
        assert amplification(x, 0.0).min() > -0.2, x
        for y in np.logspace(-2, 8, 41):
            assert amplification(x, y).real.min() > -0.5, (x, y)


@pytest.mark.parametrize(("x", "y"), [(0.0, 1.0), (1.0, 0.0), (0.3, 1.0), (2.5, 1.0)])
def test_a_mode_is_followed_to_second_order_at_least(x: float, y: float) -> None:
    """A mode alone: the spring of fourth order but for its damping, the damper like Padé's."""
    errors = []
    for h in (0.04, 0.02, 0.01):
        exact = np.exp(np.roots([1, h * x, h * h * y]))
        errors.append(
            np.abs(np.sort_complex(amplification(h * x, h * h * y)) - np.sort_complex(exact)).max()
            / h
        )
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 1.9), errors
    if 0 in (x, y):
        assert np.all(orders > 2.9), errors


def test_the_limits_are_those_of_backward_euler() -> None:
    damped, implicit = one_mode(0.0, 1e12)
    assert (damped, implicit) == pytest.approx((1e12, 1e12), rel=1e-9)
    damped, implicit = one_mode(1e12, 0.0)
    assert (damped, implicit) == pytest.approx((1e12, 1e12), rel=1e-9)


def test_a_change_is_extrapolated_without_what_an_impact_has_added() -> None:
    change = np.array([1.0, -1.0, 3.0, -3.0, 1.0, 1.0, 0.1])
    before = np.array([0.9, -2.0, 1.0, -1.0, -1.0, 0.0, 1.0])
    assert limited_change(change, before, 0.2).tolist() == [1.0, -1.0, 2.0, -2.0, 0.0, 0.0, 0.1]
    assert limited_change(change, before, 3.0) is change


@pytest.mark.parametrize(("detects_impacts", "expected"), [(False, 20.0), (True, 2.0)])
def test_bias_forces_are_not_extrapolated_with_an_impact(
    detects_impacts: bool, expected: float
) -> None:
    law = SpringDamperLaw(JointSprings(np.ones(1), np.zeros(1), np.zeros(1)), H, "implicit")
    law.detects_impacts = detects_impacts
    law.refresh(np.ones((1, 1)))
    asked: list[float] = []

    def bias_at(rates: Array) -> Array:
        asked.append(float(rates[0]))
        return np.zeros(1)

    sudden = SMOOTH / H**2
    for force in (2 * sudden, 2 * sudden, 40 * sudden):
        law.set_force(np.array([force]), np.zeros(1))
        law.correct(np.zeros(1), bias_at)
    assert asked[2] / asked[1] == pytest.approx(expected)
