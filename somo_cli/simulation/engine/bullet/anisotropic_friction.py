"""Anisotropic dry friction, as of a snake's scales: one spring for each contact point.

A contact point with normal force N that slides at the velocity v feels the friction force
F = -N μ S v / |v|, where S has the factors along the axes of the link (Hu and others, PNAS 106
(2009) 10081, equation 1, in three dimensions). A point that sticks is held by a spring and a damper
that slip at the force N μ (Cundall and Strack, Géotechnique 29 (1979) 47). They are as stiff as the
time step allows, so that the point does not creep.

The engine's own anisotropic friction cannot be used. Seen in 3.2.7: it scales two directions that
are fixed in the world. The friction on a body that slides askew to its axes then depends on its
heading. A cube with factors 0.2 and 1 that slides at 45 degrees to them feels, over the first
0.1 s, 0.28 of N μ against its motion, or 0.93, turned by 41 degrees, depending on its heading.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.engine.bullet.last_contacts import ContactKey

STIFFNESS_FACTOR = 0.1  # of a spring, times mass / step²: explicit, and 40 times from unstable
DAMPING_FACTOR = 0.16  # of a damper, times mass / step: a quarter of critical


class AnisotropicFriction:
    """The springs of all contact points, kept from one step to the next; engine units."""

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
        """Return the friction on each point, shape (p, 3), in the world, and keep its spring.

        `local_points`, (p, 3), are the points in the axes of their links: they match a point with
        its spring of the last step. `normals` and `slip_velocities`, (p, 3), are in the world.
        `limits`, (p,), are the coefficient times the normal force; `masses`, (p,), the mass that
        each spring moves; `factors`, (p, 3, 3), the matrices S in the world.
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
        # cap a slipping spring at the limit: a longer one would have to unwind first
        lengths = np.sqrt((self._spring_forces * self._spring_forces).sum(axis=1))
        self._spring_forces *= np.minimum(1.0, limits / np.maximum(lengths, 1e-300))[:, None]
        forces: Array = np.einsum("pij,pj->pi", factors, friction_forces)
        forces -= _normal_parts(forces, normals)
        return forces

    def clear(self) -> None:
        """Remove every spring, because nothing touches."""
        self._keys = ()
        self._local_points = self._spring_forces = np.zeros((0, 3))

    def _matched_springs(self, keys: Sequence[ContactKey], local_points: Array) -> Array:
        """Return the spring forces of the last step, (p, 3), matched by link pair and distance."""
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
