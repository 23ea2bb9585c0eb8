"""How much gravity and bending change a body: this decides how often its inertia is refreshed."""

from __future__ import annotations

import math

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose

TEST_BEND = 0.1  # rad: bend of the chain at which the change of its inertia is measured


def fastest_gravity_mode(pose: ChainPose, gravity: Vector, mass: Array) -> float:
    """Return the highest natural frequency [rad/s] that gravity alone gives a chain at a pose.

    It solves M q'' + G q = 0 with the base held. Where gravity makes the chain topple, it is the
    rate of toppling instead, if that is higher.
    """
    modes = np.linalg.eigvals(np.linalg.solve(mass, pose.gravity_stiffness(gravity)))
    return math.sqrt(float(np.abs(modes).max()))


def positive_gravity_stiffness(pose: ChainPose, gravity: Vector) -> Array:
    """Return the positive part of the joint stiffness of gravity at a pose, shape (n, n)."""
    values, vectors = np.linalg.eigh(pose.gravity_stiffness(gravity))
    positive: Array = (vectors * np.maximum(values, 0.0)) @ vectors.T
    return positive


def largest_inertia_change(
    chain: ChainDynamics, angles: Array, has_free_base: bool, turn: float
) -> float:
    """Return the largest relative change of modal inertia over a joint displacement `turn` [rad].

    `turn` is the Euclidean norm of the displacement. Links much lighter than what they carry can
    move while the load stays in place. Which motion does that changes as the chain bends. A mass
    matrix only slightly out of date then gives this motion many times its inertia, or a negative
    one, which no choice of B stabilises. The chain is measured at an uneven bend, because a
    straight chain shows little of this.
    """
    number = np.arange(chain.count)
    bent = angles + TEST_BEND * np.sin(1 + 2.7 * number)
    way = np.cos(0.5 + 1.9 * number)
    way *= turn / np.linalg.norm(way)
    before, after = (chain.at(one).joint_inertia(has_free_base) for one in (bent, bent + way))
    changes = np.linalg.eigvals(np.linalg.solve(before, after - before))
    return float(np.abs(changes).max())
