"""Dry friction that depends on the direction, as of a snake's scales: one spring a point.

A point of contact that slides with the velocity v, pressed on by a normal force N, is held back by
F = -N μ S v / |v|, with S the factors along the axes of the link (Hu and others, PNAS 106 (2009)
10081, equation 1, in three dimensions). A point that sticks hangs on a spring and a damper that
slip at the force N μ (Cundall and Strack, Géotechnique 29 (1979) 47), as stiff as the time step
allows, so that it does not creep.

The engine's own anisotropic friction is of no use. Seen in 3.2.7: it scales two directions that
are fixed in the world, so how a body is slowed down that slides askew depends on where in the world
its axes point. A cube of factors 0.2 and 1 that slides at 45 degrees to them is held back, over the
first 0.1 s, with 0.28 of N μ against its motion, or with 0.93, turned by 41 degrees, as it heads.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.engine.bullet.last_contacts import ContactKey

STIFFNESS_FACTOR = 0.1  # of a spring, times mass / step²: explicit, and 40 times from unstable
DAMPING_FACTOR = 0.16  # of a damper, times mass / step: a quarter of critical


class AnisotropicFriction:
    """The springs of all points of contact, from one step to the next; engine units."""

    def __init__(self, time_step: float) -> None:
        self._time_step = time_step
        self._keys: Sequence[ContactKey] = ()
        self._local_points: Array = np.zeros((0, 3))
        self._spring_forces: Array = np.zeros((0, 3))

    def forces(
        self,
        keys: Sequence[ContactKey],
        local_points: Array,
        normals: Array,
        slip_velocities: Array,
        limits: Array,
        masses: Array,
        factors: Array,
    ) -> Array:
        """Return the friction on each point, shape (p, 3), in the world, and remember its springs.

        `local_points` are the points in the axes of their links, by which they are found again,
        `normals` and `slip_velocities` their normals and relative velocities in the world, `limits`
        the coefficient times the normal force, `masses` what a spring has to move; `factors`,
        shape (p, 3, 3), the matrices S in the world.
        """
        spring_forces = self._matched_springs(keys, local_points)
        sliding = slip_velocities - _normal_parts(slip_velocities, normals)
        per_mass = masses[:, None] / self._time_step
        spring_forces = (
            spring_forces
            - _normal_parts(spring_forces, normals)
            - STIFFNESS_FACTOR * per_mass * sliding
        )
        damper_forces = DAMPING_FACTOR * per_mass * sliding
        friction_forces = spring_forces - damper_forces
        sizes = np.sqrt((friction_forces * friction_forces).sum(axis=1))
        shares = np.minimum(1.0, limits / np.maximum(sizes, 1e-300))
        friction_forces *= shares[:, None]
        self._keys, self._local_points = keys, local_points
        self._spring_forces = np.where(
            shares[:, None] < 1.0, friction_forces + damper_forces, spring_forces
        )
        # a spring that slips is no longer than the limit allows, or it would have to unwind
        lengths = np.sqrt((self._spring_forces * self._spring_forces).sum(axis=1))
        self._spring_forces *= np.minimum(1.0, limits / np.maximum(lengths, 1e-300))[:, None]
        forces: Array = np.einsum("pij,pj->pi", factors, friction_forces)
        forces -= _normal_parts(forces, normals)
        return forces

    def clear(self) -> None:
        """Forget every spring: nothing touches."""
        self._keys = ()
        self._local_points = self._spring_forces = np.zeros((0, 3))

    def _matched_springs(self, keys: Sequence[ContactKey], local_points: Array) -> Array:
        """Return the force of each spring: that of the nearest point of the same two links."""
        if not self._keys or not keys:
            return np.zeros_like(local_points)
        differences = local_points[:, None, :] - self._local_points[None, :, :]
        squares = np.einsum("ijk,ijk->ij", differences, differences)
        numbers = {key: number for number, key in enumerate(self._keys)}
        before = np.array([numbers[key] for key in self._keys])
        now = np.array([numbers.get(key, -1) for key in keys])
        is_other = now[:, None] != before[None, :]
        squares[is_other] = np.inf
        nearest = squares.argmin(axis=1)
        is_new = is_other[np.arange(len(keys)), nearest]
        found: Array = np.where(is_new[:, None], 0.0, self._spring_forces[nearest])
        return found


def _normal_parts(vectors: Array, normals: Array) -> Array:
    """Return the parts of vectors along unit normals, both of shape (p, 3)."""
    along: Array = (vectors * normals).sum(axis=1)[:, None] * normals
    return along
