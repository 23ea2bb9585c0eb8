"""Frequencies and the explicit limit, against eigenvalues of the recursion and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.dynamics.modal import (
    largest_explicit_step,
    mass_normalisation,
    natural_frequencies,
)
from tests.builders.matrices import positive_definite


@pytest.fixture
def random() -> np.random.Generator:
    """A generator of its own for every test, so that no value depends on which tests ran."""
    return np.random.default_rng(7)


def test_natural_frequencies_solve_the_generalised_eigenproblem(
    random: np.random.Generator,
) -> None:
    mass, stiffness = positive_definite(random, 5), random.uniform(1, 5, 5)
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


def test_the_explicit_limit_is_where_the_recursion_starts_to_grow(
    random: np.random.Generator,
) -> None:
    mass, stiffness, damping = positive_definite(random, 4), *random.uniform(0.1, 5, (2, 4))
    limit = largest_explicit_step(mass, stiffness, damping)
    for factor, is_stable in ((0.999, True), (1.001, False)):
        h = factor * limit
        inverse = np.linalg.inv(mass)
        on_angles = -h * inverse @ np.diag(stiffness)
        on_rates = np.eye(4) - h * inverse @ np.diag(damping)
        step = np.block([[np.eye(4) + h * on_angles, h * on_rates], [on_angles, on_rates]])
        assert (np.abs(np.linalg.eigvals(step)).max() <= 1) == is_stable


def test_a_stiffness_that_couples_joints_counts_as_a_whole(random: np.random.Generator) -> None:
    mass, stiffness = positive_definite(random, 4), positive_definite(random, 4)
    limit = largest_explicit_step(mass, stiffness, np.zeros(4))
    assert limit == pytest.approx(2 / natural_frequencies(mass, stiffness)[-1], rel=1e-12)


def test_light_links_do_not_drown_among_heavy_ones() -> None:
    """Masses over twelve orders: the limit is that of the lightest."""
    mass = np.diag([1e6, 1.0, 1e-6])
    limit = largest_explicit_step(mass, np.ones(3), np.zeros(3))
    assert limit == pytest.approx(2e-3, rel=1e-9)


def test_shapes_have_unit_masses(random: np.random.Generator) -> None:
    mass, stiffness = positive_definite(random, 5), positive_definite(random, 5)
    normalised, shaped = mass_normalisation(mass)
    squares, vectors = np.linalg.eigh(normalised(stiffness))
    shapes = shaped(vectors)
    assert shapes.T @ mass @ shapes == pytest.approx(np.eye(5), abs=1e-12)
    assert shapes.T @ stiffness @ shapes == pytest.approx(np.diag(squares), abs=1e-12)
