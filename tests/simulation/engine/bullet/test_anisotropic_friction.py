"""Friction by springs that slip: its limit, its direction, its rest, found again."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.arrays import Array
from somo_cli.simulation.engine.bullet.anisotropic_friction import AnisotropicFriction, ContactKey

STEP = 1e-3  # s
UP: Array = np.array([[0.0, 0.0, 1.0]])
KEY: tuple[ContactKey, ...] = ((1, 0, 2, -1),)
FACTORS: Array = np.diag([1.0, 0.2, 1.0])[None]


def drag(grip: AnisotropicFriction, slip: list[float], steps: int, limit: float = 2.0) -> Array:
    """Return the force on one point of mass 1 after it went with one velocity for some steps."""
    place = np.zeros((1, 3))
    for _ in range(steps):
        force = grip.forces(
            KEY, place, UP, np.array([slip]), np.array([limit]), np.ones(1), FACTORS
        )
    return force[0]


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.0, 1.5707963267948966, 3.0])
def test_what_slides_is_held_by_the_factors_of_its_direction(angle: float) -> None:
    x, y = np.cos(angle), np.sin(angle)
    found = drag(AnisotropicFriction(STEP), [0.5 * x, 0.5 * y, 0.3], 100)
    assert found == pytest.approx([-2 * x, -2 * 0.2 * y, 0], abs=1e-12)


def test_a_body_that_sticks_comes_to_rest_under_a_force_below_the_limit() -> None:
    grip, velocity, place = AnisotropicFriction(STEP), 0.0, 0.0
    for step in range(3000):
        force = drag(grip, [velocity, 0, 0], 1)
        velocity += STEP * (1.9 * min(1, step / 500) + float(force[0]))
        place += STEP * velocity
    assert velocity == pytest.approx(0, abs=1e-12)
    assert force[0] == pytest.approx(-1.9, rel=1e-9)
    # it hangs on its spring: 0.1 mass / step²
    assert place == pytest.approx(1.9 / (0.1 / STEP**2), rel=1e-6)


def test_above_the_limit_it_is_pulled_with_what_is_left() -> None:
    grip, velocity = AnisotropicFriction(STEP), 0.0
    for _ in range(1000):
        velocity += STEP * (2.5 + float(drag(grip, [velocity, 0, 0], 1)[0]))
    assert velocity == pytest.approx(0.5, rel=0.01)


def test_springs_are_found_again_by_links_and_place() -> None:
    grip = AnisotropicFriction(STEP)
    keys: tuple[ContactKey, ...] = ((1, 0, 2, -1), (1, 0, 2, -1), (1, 1, 2, -1))
    places = np.array([[0.0, 0, 0], [1.0, 0, 0], [0.0, 0, 0]])
    slips = np.array([[1e-3, 0, 0], [-1e-3, 0, 0], [2e-3, 0, 0]])
    same = np.repeat(np.eye(3)[None], 4, axis=0)
    args = np.repeat(UP, 3, axis=0), slips, np.full(3, 9.0), np.ones(3), same[:3]
    grip.forces(keys, places, *args)
    # in another order, one of them gone, and one between new links
    now: tuple[ContactKey, ...] = ((1, 2, 2, -1), (1, 1, 2, -1), (1, 0, 2, -1))
    there = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.9, 0, 0]])
    still = np.repeat(UP, 3, axis=0), np.zeros((3, 3)), np.full(3, 9.0), np.ones(3), same[:3]
    found = grip.forces(now, there, *still)[:, 0]
    assert found == pytest.approx([0, -0.1 * 2e-3 / STEP, 0.1 * 1e-3 / STEP])
    grip.clear()
    assert grip.forces(now, there, *still) == pytest.approx(0)
