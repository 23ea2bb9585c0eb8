"""How much gravity and bending change a body, which decides how often it is refreshed."""

from __future__ import annotations

import math

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose

TEST_BEND = 0.1  # rad: how far the chain is bent where it is asked how fast its inertia changes


def fastest_gravity_mode(pose: ChainPose, gravity: Vector, mass: Array) -> float:
    """Return the highest natural frequency [rad/s] that gravity alone gives a chain at a pose.

    Of M q'' + G q = 0 with the base held. Of either sign: also the rate at which a chain topples.
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
    """Return the largest relative change of inertia of any motion in a turn [rad] of the joints.

    Links much lighter than what they carry can move so that the load stays where it is. Which
    motion that is changes as the chain bends: a mass matrix that is a little old gives it many
    times its inertia, or a negative one, which no choice of B withstands. The chain is taken at an
    uneven bend, since a straight one shows little; the turn is the root of the sum of squares.
    """
    number = np.arange(chain.count)
    bent = angles + TEST_BEND * np.sin(1 + 2.7 * number)
    way = np.cos(0.5 + 1.9 * number)
    way *= turn / np.linalg.norm(way)
    before, after = (chain.at(one).joint_inertia(has_free_base) for one in (bent, bent + way))
    changes = np.linalg.eigvals(np.linalg.solve(before, after - before))
    return float(np.abs(changes).max())
