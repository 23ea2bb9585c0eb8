"""The change of contact forces: closed forms of one and two points, and the laws of contact."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.integrator import contact_change
from somo_cli.simulation.integrator.contact_change import (
    ContactProblem,
    Surfaces,
    rows_of_points,
)
from somo_cli.simulation.integrator.contact_states import SLIDING, STICKING

STEP = 1e-3  # s
MASS = 2.0  # kg


def problem(friction: float = 0.5, compliance: float = 0.0, points: int = 1) -> ContactProblem:
    """Return the problem of a mass point that stands on so many points at one place."""
    surfaces = Surfaces(*(np.full(points, value) for value in (friction, 0.1, compliance)))
    delassus = np.tile(np.eye(3) / MASS, (points, points))
    return ContactProblem(delassus, surfaces, STEP)


def solved(
    one: ContactProblem, states: int, force: list[float], velocity: list[float], free: list[float]
) -> np.ndarray:
    """Return the whole force on one point; axes are the normal and two across it."""
    rows = [np.array(values, dtype=float) for values in (force, velocity, free)]
    found = one.solve([states], *rows, np.zeros(1))
    assert found is not None
    return found + np.array(force)


@pytest.fixture(autouse=True)
def exact(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_change, "REGULAR", 1e-12)


def test_what_sticks_is_brought_to_rest() -> None:
    force = solved(problem(), STICKING, [10, 0, 0], [0, 0, 0], [-3e-4, 1e-4, -2e-4])
    assert force == pytest.approx(np.array([10.6, -0.2, 0.4]))  # 10 - m v / h


def test_what_would_pull_is_let_go() -> None:
    assert solved(problem(), STICKING, [10, 1, 0], [0, 0, 0], [1e-2, 0, 0]) == pytest.approx(
        np.zeros(3), abs=1e-9
    )


def test_a_point_that_cannot_stick_slides_with_the_friction_limit_against_its_velocity() -> None:
    force = solved(problem(), STICKING, [10, -4.9, 0], [0, 1e-3, 0], [0, 1e-3, 0])
    assert force == pytest.approx(np.array([10, -5, 0]))


def test_friction_that_slides_follows_the_normal_force() -> None:
    force = solved(problem(), SLIDING, [10, -5, 0], [0, 1, 0], [-1e-3, 1, 0])
    assert force == pytest.approx(np.array([12, -6, 0]))


def test_friction_turns_with_the_velocity() -> None:
    """By the angle to which the velocity has turned, which friction lessens in the step."""
    force = solved(problem(), SLIDING, [10, -5, 0], [0, 1, 0], [0, 1, 0.01])
    across = 0.01 / (1 + STEP * 5 / 1 / MASS)
    assert force == pytest.approx(np.array([10, -5, -5 * across]))


def test_what_sticks_again_does_not_slide_backwards() -> None:
    force = solved(problem(), SLIDING, [10, -5, 0], [0, 1e-4, 0], [0, -1e-3, 0])
    assert force == pytest.approx(np.array([10, -3, 0]))


def test_soft_ground_is_an_implicit_spring() -> None:
    """F = F0 - (h k + c) v with v the velocity that it leaves: v = free + h (F - F0) / m."""
    compliance = 0.05
    rest = np.array([-10 * compliance, 0.0, 0.0])  # the velocity that F0 alone belongs to
    force = solved(problem(compliance=compliance), STICKING, [10, 0, 0], [0, 0, 0], rest.tolist())
    assert force[0] == pytest.approx(10.0)


def test_points_that_are_redundant_share_a_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even if they ask for what cannot be: one for a velocity that the other does not."""
    monkeypatch.setattr(contact_change, "REGULAR", 1e-3)
    one = problem(points=2)
    forces = np.array([1e3, 0, 0, 1e3, 0, 0])
    free = np.array([-1e-3, 0, 0, -1e-3, 0, 0])
    still = np.zeros(6)
    change = one.solve([STICKING] * 2, forces, still, free, np.array([0.0, 1e-4]))
    assert change is not None
    assert np.abs(change).max() < 200
    assert change[0] + change[3] == pytest.approx(2 * 1.05, rel=1e-2)


def test_operators_do_what_the_solution_does_while_no_state_changes() -> None:
    """At coupled points that stick, slide, and slide without friction, on rigid and soft ground."""
    rng = np.random.default_rng(1)
    friction = np.array([0.5, 0.3, 0.0, 0.4])
    assert rows_of_points(friction).tolist() == [0, 1, 2, 3, 4, 5, 6, 9, 10, 11]
    root = rng.normal(size=(10, 15))
    surfaces = Surfaces(friction, np.full(4, 0.1), np.array([0, 0.1, 0, 0.2]))
    one = ContactProblem(root @ root.T, surfaces, STEP)
    assert one.normals == [0, 3, 6, 7]
    states = [STICKING, SLIDING, SLIDING, SLIDING]
    forces = np.array([1e3, 1, 2, 1e3, -300, 0, 1e3, 1e3, 240, 320])
    velocities = np.array([0, 0, 0, 0, 1, 0.1, 0, 0, -3, -4])
    free = velocities + 1e-4 * rng.normal(size=10)
    free[:3] *= 1e-2
    target = 1e-4 * rng.normal(size=4) + 1e3 * surfaces.compliance  # close to how they press
    need = -free / STEP
    need[one.normals] += target / STEP
    by_need, by_force = one.operators(states, forces, velocities)
    change = one.solve(states, forces, velocities, free, target)
    assert change is not None
    assert by_need @ need + by_force @ forces == pytest.approx(change, rel=1e-9, abs=1e-9)
    whole = change + forces
    assert whole[4] == pytest.approx(-0.3 * whole[3])  # the limit, against the way
    assert whole[8:10] @ [0.6, 0.8] == pytest.approx(0.4 * whole[7])


def test_what_cannot_be_solved_has_no_change() -> None:
    still = np.zeros(3)
    one = problem()
    assert one.solve([STICKING], np.array([np.nan, 0, 0]), still, still, np.zeros(1)) is None
