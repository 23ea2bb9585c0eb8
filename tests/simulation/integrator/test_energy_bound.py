"""What energy a body has, and what it may have."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.plan.joint_springs import JointSprings
from tests.builders.fake_world import (
    HINGE_INERTIA,
    HINGE_NEUTRAL,
    HINGE_STIFFNESS,
    energy_of_hinge,
    plan_of_hinges,
)


def test_the_energy_is_that_of_motion_and_springs() -> None:
    energy = energy_of_hinge()
    energy.update(np.array([0.4]), np.array([3.0]), HINGE_INERTIA * np.eye(1))
    expected = 0.5 * HINGE_INERTIA * 9 + 0.5 * HINGE_STIFFNESS * 0.3**2
    assert energy.present == pytest.approx(expected)
    assert energy.bound == pytest.approx(expected)
    shares = energy.joint_shares(np.array([3.0]), HINGE_INERTIA * np.eye(1))
    assert shares == pytest.approx([expected])


def test_the_energies_of_many_states_are_those_of_each() -> None:
    random = np.random.default_rng(5)
    plan = plan_of_hinges(3)
    springs = JointSprings(np.array([20.0, 5.0, 1.0]), np.zeros(3), np.array([0.1, -0.2, 0.3]))
    energy = BodyEnergy(plan.bodies[0], springs, (0.0, 0.0, 0.0))
    angles, rates = random.normal(size=(2, 7, 3))
    first, second = (one @ one.T + np.eye(3) for one in random.normal(size=(2, 3, 3)))
    masses = [first, first, second, second, second, first, second]
    expected = []
    for state in zip(angles, rates, masses, strict=True):
        energy.update(*state)
        expected.append(energy.present)
    assert energy.energies(angles, rates, masses) == pytest.approx(expected, rel=1e-13)
    assert energy.energies(angles[:0], rates[:0], []).shape == (0,)


def test_the_bound_grows_by_the_most_work_done() -> None:
    energy = energy_of_hinge()
    energy.update(np.array([HINGE_NEUTRAL]), np.zeros(1), HINGE_INERTIA * np.eye(1))
    bounds = []
    for work in (0.0, 0.6, 0.6, -1.6, 0.5):
        energy.add_work(work)
        bounds.append(energy.bound)
    assert bounds == pytest.approx([0.0, 0.6, 1.2, 1.2, 1.2])


def test_the_bound_knows_gravity_and_the_base() -> None:
    still = energy_of_hinge()
    heavy = energy_of_hinge(gravity=9.81)
    thrown = energy_of_hinge(linear_velocity=(0.0, 3.0, 0.0), angular_velocity=(1.0, 0.0, 0.0))
    assert still.bound == 0.0
    # two links of 1.5 g whose centres are 5 mm and 15 mm from the base's origin, twice over
    assert heavy.bound == pytest.approx(9.81 * 2 * 0.0015 * (0.005 + 0.015), rel=1e-6)
    assert thrown.bound > 0.5 * 0.003 * 9
    heavy.bound_base_fall(2.0)
    heavy.bound_base_fall(1.0)
    assert heavy.bound == pytest.approx(9.81 * (2 * 0.0015 * 0.02 + 0.003 * 2.0), rel=1e-6)
