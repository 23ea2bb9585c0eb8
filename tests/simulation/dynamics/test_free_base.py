"""A free base is eliminated: held against the whole equations of motion, and a pair of bodies."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.dynamics.free_base import FreeBase


def test_the_joints_accelerate_as_in_the_whole_equations() -> None:
    numbers = np.random.default_rng(3)
    root = numbers.normal(size=(9, 9))
    inertia = root @ root.T + np.eye(9)
    forces = numbers.normal(size=9)
    base = FreeBase.of(inertia)
    whole = np.linalg.solve(inertia, forces)
    joints = np.linalg.solve(base.joint_inertia, base.joint_torques(forces))
    assert joints == pytest.approx(whole[6:])
    # and the base as its own equation has it
    at_base = base.inverse @ forces[:6] - base.to_joints.T @ joints
    assert at_base == pytest.approx(whole[:6])
    assert np.array_equal(base.joint_inertia, base.joint_inertia.T)


def test_two_masses_on_a_slide_feel_their_reduced_mass() -> None:
    """m1 m2 / (m1 + m2), where a coordinate moves one mass along against the other."""
    first, second = 2.0, 3.0
    inertia = np.eye(7)
    inertia[3, 3] = first + second  # the base along x, with the other mass on it
    inertia[3, 6] = inertia[6, 3] = inertia[6, 6] = second
    base = FreeBase.of(inertia)
    assert base.joint_inertia == pytest.approx(np.array([[first * second / (first + second)]]))
    # gravity along the slide moves both alike, and the joint feels nothing of it
    weight = np.array([0, 0, 0, first + second, 0, 0, second]) * -9.81
    assert base.joint_torques(weight) == pytest.approx(0.0, abs=1e-14)
