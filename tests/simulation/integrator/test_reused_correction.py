"""A reused correction is one product; it is tested against the formulas written plainly."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.reused_correction import ReusedCorrection
from tests.builders.spring_laws import (
    H,
    inertia,
    plain_torques,
    spring_damper_torques,
    springs,
    torques_with_nothing_to_correct,
)


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_one_product_is_the_law(integrator: str) -> None:
    numbers = np.random.default_rng(3)
    law, mass = SpringDamperLaw(springs(), H, integrator), inertia()
    of_step = torques_with_nothing_to_correct(law, mass)
    v_prev = tau_prev = np.zeros(3)
    for _ in range(4):
        q, v, u = numbers.normal(size=(3, 3))
        law.angles[:], law.rates[:], law.actuation[:] = q, v, u
        torques = of_step()
        assert torques == pytest.approx(plain_torques(law, mass, q, v, v_prev, tau_prev, u))
        v_prev, tau_prev = v, np.array(torques)


def test_a_held_correction_goes_on_as_it_grew_and_the_bias_as_it_fell() -> None:
    numbers = np.random.default_rng(4)
    law, mass = SpringDamperLaw(springs(), H, "implicit"), inertia()
    law.refresh(mass)
    reused = ReusedCorrection(law)
    bias, coming, fall, growth = numbers.normal(size=(4, 3))
    law.correct(bias, lambda rates: coming)
    v_prev, tau_prev = law.rates.copy(), law.state.previous_torques.copy()
    for _ in range(2):  # the second time, nothing is left of the first
        reused.extrapolate(fall, growth, 4)
        for number in range(1, 5):
            q, v, u = numbers.normal(size=(3, 3))
            law.angles[:], law.rates[:], law.actuation[:] = q, v, u
            held = u + bias - coming + growth * number / 4
            expected = plain_torques(law, mass, q, v, v_prev, tau_prev - fall / 4, held)
            torques = reused.torques()
            assert torques == pytest.approx(expected)
            v_prev, tau_prev = v, np.array(torques)


def test_a_new_mass_matrix_leaves_the_measured_force() -> None:
    law, mass = SpringDamperLaw(springs(), H, "implicit"), inertia()
    reused, nothing = ReusedCorrection(law), np.zeros(3)
    law.refresh(mass)
    reused.extrapolate(nothing, nothing, 1)
    law.rates[:] = [1.0, 2.0, 3.0]
    before = np.array(reused.torques())
    law.rates[:] = [1.1, 1.9, 3.2]
    heavier = mass + np.eye(3)
    law.refresh(heavier)
    reused.extrapolate(nothing, nothing, 1)
    force = mass @ [0.1, -0.1, 0.2] / H - before
    damping, b = law.coefficients.matrices(heavier)
    springs_alone = spring_damper_torques(law.springs, law.angles, np.zeros(3))
    s = springs_alone - damping @ law.rates
    acceleration = np.linalg.solve(heavier + b, force + s)
    assert reused.torques() == pytest.approx(s - b @ acceleration)


def test_a_prediction_has_the_same_torques_and_the_acceleration_that_they_bring() -> None:
    """M a = f + τ; what contact adds to a is taken off by B, as in the law itself."""
    numbers = np.random.default_rng(5)
    laws = [SpringDamperLaw(springs(), H, "implicit") for _ in range(2)]
    mass, (bias, coming, fall, growth, change) = inertia(), numbers.normal(size=(5, 3))
    reused = []
    for law in laws:
        law.refresh(mass)
        law.correct(bias, lambda rates: coming)
        reused.append(ReusedCorrection(law))
        reused[-1].extrapolate(fall, growth, 4)
    predicting = laws[0]
    q, v, u = numbers.normal(size=(3, 3))
    for step in range(1, 3):
        v = v + 0.1 * step
        for law in laws:
            law.angles[:], law.rates[:], law.actuation[:] = q, v, u
        v_prev = predicting.previous_rates.copy()
        tau_prev = predicting.state.previous_torques.copy()
        reused[0].predict()
        expected = reused[1].torques()
        force = mass @ (v - v_prev) / H - tau_prev + fall / 4
        acceleration = np.linalg.solve(mass, force + expected)
        assert predicting.predicted == pytest.approx(acceleration)
        assert predicting.settle() == expected
    reused[0].predict()
    _, implicit = predicting.coefficients.matrices(mass)
    assert predicting.settle(change) == pytest.approx(reused[1].torques() - implicit @ change)
