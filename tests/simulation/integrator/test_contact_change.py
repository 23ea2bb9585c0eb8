"""The change of contact forces: closed forms of one and two points, and the laws of contact."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.integrator import contact_change
from somo_cli.simulation.integrator.contact_change import (
    SLIDING,
    STICKING,
    ContactProblem,
    Surfaces,
)

STEP = 1e-3  # s
MASS = 2.0  # kg
UP = np.array([[0.0, 0.0, 1.0]])


def problem(friction: float = 0.5, compliance: float = 0.0, points: int = 1) -> ContactProblem:
    """Return the problem of a mass point that stands on so many points at one place."""
    surfaces = Surfaces(*(np.full(points, value) for value in (friction, 0.1, compliance)))
    delassus = np.tile(np.eye(3) / MASS, (points, points))
    return ContactProblem(delassus, np.repeat(UP, points, 0), surfaces, STEP)


def solved(
    one: ContactProblem, states: int, force: list[float], velocity: list[float], free: list[float]
) -> np.ndarray:
    """Return the whole force on one point, by the operators where they break no law."""
    rows = [np.array([values]) for values in (force, velocity, free)]
    found = one.solve(np.array([states]), *rows, np.zeros(1))
    assert found is not None
    return found + np.array(force)


@pytest.fixture(autouse=True)
def exact(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_change, "REGULAR", 1e-12)


def test_what_sticks_is_brought_to_rest() -> None:
    force = solved(problem(), STICKING, [0, 0, 10], [0, 0, 0], [1e-4, -2e-4, -3e-4])
    assert force == pytest.approx(np.array([-0.2, 0.4, 10.6]))  # 10 - m v / h


def test_what_would_pull_is_let_go() -> None:
    assert solved(problem(), STICKING, [1, 0, 10], [0, 0, 0], [0, 0, 1e-2]) == pytest.approx(
        np.zeros(3), abs=1e-9
    )


def test_a_point_that_cannot_stick_slides_with_the_friction_limit_against_its_velocity() -> None:
    force = solved(problem(), STICKING, [-4.9, 0, 10], [1e-3, 0, 0], [1e-3, 0, 0])
    assert force == pytest.approx(np.array([-5, 0, 10]))


def test_friction_that_slides_follows_the_normal_force() -> None:
    force = solved(problem(), SLIDING, [-5, 0, 10], [1, 0, 0], [1, 0, -1e-3])
    assert force == pytest.approx(np.array([-6, 0, 12]))


def test_friction_turns_with_the_velocity() -> None:
    """By the angle to which the velocity has turned, which friction lessens in the step."""
    force = solved(problem(), SLIDING, [-5, 0, 10], [1, 0, 0], [1, 0.01, 0])
    across = 0.01 / (1 + STEP * 5 / 1 / MASS)
    assert force == pytest.approx(np.array([-5, -5 * across, 10]))


def test_what_sticks_again_does_not_slide_backwards() -> None:
    force = solved(problem(), SLIDING, [-5, 0, 10], [1e-4, 0, 0], [-1e-3, 0, 0])
    assert force == pytest.approx(np.array([-3, 0, 10]))


def test_soft_ground_is_an_implicit_spring() -> None:
    """F = F0 - (h k + c) v with v the velocity that it leaves: v = free + h (F - F0) / m."""
    compliance = 0.05
    rest = np.array([0.0, 0.0, -10 * compliance])  # the velocity that F0 alone belongs to
    force = solved(problem(compliance=compliance), STICKING, [0, 0, 10], [0, 0, 0], rest.tolist())
    assert force[2] == pytest.approx(10.0)


def test_points_that_are_redundant_share_a_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even if they ask for what cannot be: one for a velocity that the other does not."""
    monkeypatch.setattr(contact_change, "REGULAR", 1e-3)
    one = problem(points=2)
    forces = np.array([[0, 0, 1e3], [0, 0, 1e3]])
    free = np.array([[0, 0, -1e-3], [0, 0, -1e-3]])
    still = np.zeros((2, 3))
    change = one.solve(np.array([STICKING] * 2), forces, still, free, np.array([0.0, 1e-4]))
    assert change is not None
    assert np.abs(change).max() < 200
    assert change[2] + change[5] == pytest.approx(2 * 1.05, rel=1e-2)
