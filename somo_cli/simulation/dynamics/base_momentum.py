"""The momentum of a body with a free base, and the base velocity that keeps it.

The momentum of the whole body, linear P and angular L about its centre of mass, is kept where
nothing acts from outside, whatever its joints do. With velocities at half steps it is that of the
pose halfway: the base turned by half of its step, the joints moved by half of theirs. So the spin ω
of a coming step solves

    I ω + l = exp(-h ω / 2) L

in the axes that the base has before it, where I is the inertia of the body about its centre of mass
and l the angular momentum of the joint rates, both at the pose halfway. This is the rule for rigid
bodies in `gyroscopic`, with joints. P gives the velocity of the base after that.

Coordinates are those of the engine: the spin of the base and the velocity of its centre of mass, in
the base's own axes, then the joint rates, 6 + n of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array, invert
from somo_cli.simulation.dynamics.cross_products import skew_matrices
from somo_cli.simulation.dynamics.gyroscopic import half_turned

_TOLERANCE = 1e-12  # residual of a solution, relative to the momentum
_MAX_ITERATIONS = 30  # 5 are enough for steps up to 0.3 rad
_MAX_ERROR = 1e100  # engine units; beyond it products overflow
_SLOW_RATIO = 0.1  # if an iteration leaves more of the error than this, refresh the slope


@dataclass(frozen=True, slots=True)
class Momentum:
    """Linear momentum and angular momentum about the centre of mass, shape (3,) each."""

    linear: Array
    angular: Array


class WholeInertia:
    """A body as one rigid mass, from its inertia matrix (6 + n, 6 + n) and joint rates (n,)."""

    def __init__(self, matrix: Array, rates: Array) -> None:
        mass = matrix[3, 3]
        first_moment = matrix[3:6, :3]  # m times minus the cross product of its centre
        across = first_moment.T / mass
        moving = matrix[:6, 6:] @ rates
        self.mass: float = float(mass)
        self._first_moment = first_moment
        self._linear_of_joints: Array = moving[3:]
        self._angular_of_joints: Array = moving[:3] - across @ moving[3:]
        self._inertia: Array = matrix[:3, :3] - across @ first_moment

    def momentum(self, spin: Array, velocity: Array) -> Momentum:
        """Return the momentum, in the base's axes, for this motion of the base."""
        linear = self._first_moment @ spin + self.mass * velocity + self._linear_of_joints
        return Momentum(linear, self._inertia @ spin + self._angular_of_joints)

    def spin(self, angular: Array, guess: Array, time_step: float) -> Array | None:
        """Return the spin of the step, (3,), that keeps the angular momentum.

        `angular` is in the axes of the base before the step. Newton's method from a guess, with a
        slope that is renewed where it converges slowly; None if it does not converge.
        """
        x, y, z = angular.tolist()
        tolerance = _TOLERANCE * (abs(x) + abs(y) + abs(z))
        spin, slope, before = guess, None, math.inf
        for _ in range(_MAX_ITERATIONS):
            wx, wy, wz = spin.tolist()
            left = np.array(half_turned((x, y, z), (wx, wy, wz), time_step))
            error = left - self._angular_of_joints - self._inertia @ spin
            size = float(np.abs(error).max())
            if size <= tolerance:
                return spin
            if not size < _MAX_ERROR:
                return None
            if slope is None or size > _SLOW_RATIO * before:
                slope = self._inverse_slope(left, 0.5 * time_step * spin, 0.5 * time_step)
            spin = spin + slope @ error
            before = size
        return None

    def _inverse_slope(self, left: Array, turn: Array, half_step: float) -> Array:
        """Return the inverse of minus the derivative of the error by `spin`, (3, 3)."""
        # exp(-v) L with v = h ω / 2 changes by l x (J dv); see `gyroscopic`
        across, turning = skew_matrices(np.array([left, turn]))
        change = across - 0.5 * across @ turning + across @ turning @ turning / 6
        return invert(self._inertia - half_step * change)

    def velocity(self, linear: Array, spin: Array) -> Array:
        """Return the velocity of the base, (3,), that gives the body this linear momentum."""
        left: Array = linear - self._first_moment @ spin - self._linear_of_joints
        return left / self.mass


def turned_half_way(vector: Array, spin: Array, time_step: float) -> Array:
    """Return exp(-h ω / 2) v, shape (3,): a vector in axes that turn by half of a step."""
    x, y, z = vector.tolist()
    return np.array(half_turned((x, y, z), tuple(spin.tolist()), time_step))
