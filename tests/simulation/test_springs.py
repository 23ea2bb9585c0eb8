"""The law is arithmetic: it is tested against the same formulas written plainly."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.springs import (
    SpringLaw,
    Springs,
    largest_explicit_step,
    natural_frequencies,
)

H = 1e-2
RANDOM = np.random.default_rng(7)


def springs(n: int = 3) -> Springs:
    return Springs(
        RANDOM.uniform(1, 5, n), RANDOM.uniform(0.01, 0.1, n), RANDOM.uniform(-0.2, 0.2, n)
    )


def inertia(n: int = 3) -> np.ndarray:
    root = RANDOM.normal(size=(n, n))
    return root @ root.T + n * np.eye(n)


def plain_torques(law: SpringLaw, mass: np.ndarray, q, v, v_prev, tau_prev, u) -> np.ndarray:
    """Return τ by the formulas of the module's docstring, one after the other."""
    k, d, q0 = law.springs.stiffness, law.springs.damping, law.springs.neutral
    b = np.diag(law.implicit_inertia())
    damping = d + H * k if law.integrator == "euler" else d
    s = u - k * (q - q0) - damping * v
    f = mass @ (v - v_prev) / H - tau_prev
    a = np.linalg.solve(mass + b, f + s)
    return s - b @ a


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_one_product_is_the_law(integrator: str) -> None:
    law, mass = SpringLaw(springs(), H, integrator), inertia()
    law.refresh(mass)
    hold = law.make_hold()
    v_prev = tau_prev = np.zeros(3)
    for _ in range(4):
        q, v, u = RANDOM.normal(size=(3, 3))
        law.angles[:], law.rates[:], law.actuation[:] = q, v, u
        torques = hold()
        assert torques == pytest.approx(plain_torques(law, mass, q, v, v_prev, tau_prev, u))
        v_prev, tau_prev = v, np.array(torques)


def test_the_correction_acts_like_actuation_and_the_lag_of_the_bias_like_force() -> None:
    law, mass = SpringLaw(springs(), H, "implicit"), inertia()
    law.refresh(mass)
    quadratic = RANDOM.normal(size=(3, 3, 3))

    def bias_at(rates: np.ndarray) -> np.ndarray:
        return quadratic @ rates @ rates

    v_prev = tau_prev = np.zeros(3)
    bias_prev = None
    for _ in range(3):
        q, v, u = RANDOM.normal(size=(3, 3))
        law.angles[:], law.rates[:], law.actuation[:] = q, v, u
        torques = law.correct(bias_at(v), bias_at)
        lag = np.zeros(3) if bias_prev is None else bias_prev - bias_at(v)
        first = plain_torques(law, mass, q, v, v_prev, tau_prev - lag, u)
        b = np.diag(law.implicit_inertia())
        # τ = s - B a, so a = B⁻¹ (s - τ); half a step of it leads to the rates of the instant
        s = u + law.springs.torques(q, v)
        coming = v + 0.5 * H * np.linalg.solve(b, s - first)
        change = bias_at(v) - bias_at(coming)
        whole = plain_torques(law, mass, q, v, v_prev, tau_prev - lag, u + change)
        assert torques == pytest.approx(whole)
        v_prev, tau_prev, bias_prev = v, np.array(torques), bias_at(v)


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_at_rest_the_torque_is_the_spring_s(integrator: str) -> None:
    """Whatever the step: f balances s, so a is zero, and statics are exact."""
    law, mass = SpringLaw(springs(), H, integrator), inertia()
    law.refresh(mass)
    law.angles[:], law.actuation[:] = [0.3, -0.1, 0.5], [1.0, 2.0, -1.0]
    expected = law.actuation + law.springs.torques(law.angles, law.rates)
    law.measure(-expected)
    assert law.make_hold()() == pytest.approx(expected, rel=1e-12)
    assert law.acceleration(mass, -expected) == pytest.approx(0, abs=1e-12)


def test_a_new_mass_matrix_leaves_the_measured_force() -> None:
    law, mass = SpringLaw(springs(), H, "implicit"), inertia()
    law.refresh(mass)
    hold = law.make_hold()
    law.rates[:] = [1.0, 2.0, 3.0]
    before = np.array(hold())
    law.rates[:] = [1.1, 1.9, 3.2]
    heavier = mass + np.eye(3)
    law.refresh(heavier)
    force = mass @ [0.1, -0.1, 0.2] / H - before
    b = np.diag(law.implicit_inertia())
    s = law.springs.torques(law.angles, law.rates)
    acceleration = np.linalg.solve(heavier + b, force + s)
    assert hold() == pytest.approx(s - b @ acceleration)


@pytest.mark.parametrize("stiffer", [1.0, 1e4, 1e8])
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_the_linear_chain_is_stable_however_stiff(integrator: str, stiffer: float) -> None:
    soft = springs()
    stiff = Springs(soft.stiffness * stiffer, soft.damping, soft.neutral)
    law, mass = SpringLaw(stiff, H, integrator), inertia()
    law.refresh(mass)
    hold = law.make_hold()
    angles, rates = np.array([0.3, -0.2, 0.1]), np.zeros(3)
    law.angles[:] = angles
    law.rates[:] = rates = (
        -0.5 * H * law.acceleration(mass, np.zeros(3)) * (integrator == "implicit")
    )
    law.measure(np.zeros(3))
    largest = 0.0
    for _ in range(3000):
        law.angles[:], law.rates[:] = angles, rates
        rates = rates + H * np.linalg.solve(mass, hold())
        angles = angles + H * rates
        largest = max(largest, float(np.abs(angles).max()))
    assert largest < 2


def test_beta_is_chosen_by_what_the_step_resolves() -> None:
    n = 3
    mass = np.eye(n)
    for stiffness, beta in ((990.0**2, 0.3), (1010.0**2, 0.5)):
        law = SpringLaw(Springs(np.full(n, stiffness), np.zeros(n), np.zeros(n)), H, "implicit")
        law.refresh(mass)
        assert law.implicit_inertia() == pytest.approx(beta * H * H * stiffness)


def test_natural_frequencies_solve_the_generalised_eigenproblem() -> None:
    mass, stiffness = inertia(5), RANDOM.uniform(1, 5, 5)
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(mass, np.diag(stiffness))).real)
    assert natural_frequencies(mass, stiffness) == pytest.approx(np.sqrt(squares))


@pytest.mark.parametrize("zeta", [0.0, 0.1, 1.0, 5.0])
def test_the_explicit_limit_of_one_mode(zeta: float) -> None:
    """Of x'' + 2 ζ ω x' + ω² x = 0 under symplectic Euler: h ω = 2 (√(1 + ζ²) - ζ)."""
    omega = 7.0
    step = largest_explicit_step(np.eye(1), np.array([omega**2]), [2 * zeta * omega])
    assert step * omega == pytest.approx(2 * (np.sqrt(1 + zeta**2) - zeta), rel=1e-9)


def test_without_springs_every_explicit_step_is_stable() -> None:
    assert largest_explicit_step(np.eye(2), np.zeros(2), [0.0, 0.0]) == float("inf")


def test_the_explicit_limit_is_where_the_recursion_starts_to_grow() -> None:
    mass, own = inertia(4), springs(4)
    limit = largest_explicit_step(mass, own.stiffness, own.damping)
    for factor, is_stable in ((0.999, True), (1.001, False)):
        h = factor * limit
        inverse = np.linalg.inv(mass)
        on_angles = -h * inverse @ np.diag(own.stiffness)
        on_rates = np.eye(4) - h * inverse @ np.diag(own.damping)
        step = np.block([[np.eye(4) + h * on_angles, h * on_rates], [on_angles, on_rates]])
        assert (np.abs(np.linalg.eigvals(step)).max() <= 1) == is_stable
