"""Momentum of a whole body from its inertia, and the motion of its base from that."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.base_momentum import WholeInertia, turned_half_way
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.dynamics.gyroscopic import midpoint_rate
from tests.builders.definitions import EVERYTHING, bent, chain_of

RANDOM_MOTION = np.random.default_rng(5).normal(size=100)


def pose_and_motion() -> tuple[ChainPose, Array]:
    chain = chain_of(EVERYTHING)
    pose = ChainDynamics(chain).at(bent(chain))
    return pose, RANDOM_MOTION[: 6 + len(chain.joints)]


def test_momentum_is_the_sum_over_the_links() -> None:
    pose, motion = pose_and_motion()
    linear, angular = pose._jacobians()
    velocities, spins = linear @ motion, angular @ motion
    masses = pose.chain.masses
    centre = masses @ pose.centres / masses.sum()
    turning = np.einsum(
        "lij,ljk,lmk,lm->li", pose.rotations, pose.chain.inertias, pose.rotations, spins
    )
    whole_angular = (masses[:, None] * np.cross(pose.centres - centre, velocities) + turning).sum(0)
    whole = WholeInertia(pose.mass_matrix(), motion[6:])
    found = whole.momentum(motion[:3], motion[3:6])
    assert found.linear == pytest.approx(masses @ velocities)
    assert found.angular == pytest.approx(whole_angular)
    assert whole.velocity(found.linear, motion[:3]) == pytest.approx(motion[3:6])


@pytest.mark.parametrize("angle", [0.01, 0.3, 1.0, -0.5])
def test_the_spin_of_a_step_keeps_the_angular_momentum(angle: float) -> None:
    pose, motion = pose_and_motion()
    spin = motion[:3] / np.linalg.norm(motion[:3])
    whole = WholeInertia(pose.mass_matrix(), 0.1 * motion[6:])
    half_way = whole.momentum(spin, motion[3:6]).angular
    before = turned_half_way(half_way, spin, -angle)
    found = whole.spin(before, spin + 0.05, angle)
    assert found is not None
    left = whole.momentum(found, motion[3:6]).angular
    assert turned_half_way(before, found, angle) == pytest.approx(left, rel=1e-10)
    assert np.linalg.norm(left) == pytest.approx(np.linalg.norm(before))


def test_without_joints_in_motion_it_is_the_rule_for_rigid_bodies() -> None:
    moments, spin = (1e-3, 2e-3, 2.5e-3), np.array([3.0, 400.0, -20.0])
    matrix = np.diag([*moments, 2.0, 2.0, 2.0, 1.0])
    momentum = spin * moments
    found = WholeInertia(matrix, np.zeros(1)).spin(momentum, spin, 1e-3)
    x, y, z = momentum.tolist()
    assert found == pytest.approx(midpoint_rate(moments, (x, y, z), (3.0, 400.0, -20.0), 1e-3))


@pytest.mark.parametrize("size", [1e300, np.nan])
def test_no_spin_has_a_momentum_that_is_no_number(size: float) -> None:
    whole = WholeInertia(np.eye(7), np.zeros(1))
    assert whole.spin(np.full(3, size), np.zeros(3), 1.0) is None
