"""The change of contact forces that the coming step brings: a small linear problem with signs.

Forces F, (m, 3), act at m points. A change D of them changes the relative velocities there, over
the coming step h, by h W D. Let `free` be the relative velocities at its end for D = 0, n the
normals, g the gaps. As the engine does, the step brings each point that sticks to

    v = t n,  t = -g/h where there is a gap, else -r g/h with the recovery r,

and in points that slide the friction is mu times the normal force, against the velocity: along the
direction d of F as it is, and across it, p = n x d, as if it were a damper mu N / |v|, which turns
the force with the velocity. A soft surface of stiffness k and damping c adds the normal
compliance 1 / (h k + c) and makes r = h k / (h k + c), which is the implicit spring and damper.
With S the compliances of both kinds [velocity / force], the rows of points that press are

    E' (h W D + S (F + D) + free - t n) = 0,   F + D = P F + C y,

C the directions in which forces may change, P F the part of F that obeys the law of friction. No
force pulls, and those that stick are no larger than mu N: points that would break this are opened,
or slide, and the problem is solved anew. Duriez and others, IEEE TVCG 12 (2006) 36, foresee
contact with the compliance of implicit steps likewise; here what changes is foreseen, so that
equilibria stay those of the engine.

Where more points press than hold a body, as those of two faces, W is singular and what the points
ask for need not be possible. So W is made a little larger on its diagonal: with 1e-10 of its mean
fingers that held a cube by two points each threw it away, from 1e-4 to 1e-2 all is well. It takes
a share off the change where many points share it, and nothing off equilibria, which have none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array

ROUNDS = 8  # of solving anew: almost always one or two are enough
LIMIT = 1e-5  # relative: friction as near to its limit slides
SIGN = 1e-9  # relative: a normal force that is smaller, and negative, does not pull
REGULAR = 1e-3  # of the mean compliance: see above

OPEN, STICKING, SLIDING = 0, 1, 2


@dataclass(frozen=True, slots=True)
class Surfaces:
    """Of each point: coefficient of friction, recovery, and normal compliance, shape (m,) each."""

    friction: Array
    recovery: Array
    compliance: Array


class ContactProblem:
    """The problem at points that stay the same for a few steps.

    `states` below tell which points stick and which slide, (m,); `forces`, (m, 3), are F, and
    `velocities`, (m, 3), relative velocities of first to second now.
    """

    def __init__(self, compliance: Array, normals: Array, surfaces: Surfaces, step: float) -> None:
        """Take W, (3 m, 3 m), which is positive semidefinite, the normals, and the step h [s]."""
        size = len(compliance)
        self._compliance = compliance.copy()
        self._compliance.flat[:: size + 1] += REGULAR * np.trace(compliance) / size
        self._normals = normals
        self._surfaces = surfaces
        self._step = step

    def operators(
        self, states: Array, forces: Array, velocities: Array
    ) -> tuple[Array, Array, Array]:
        """Return K, L and N: D = K (t n - free) / h + L F, and the whole forces seen in N (F + D).

        Shape (3 m, 3 m) each; N turns the forces of each point into the normal force and two of
        friction, those of friction over its coefficient where the point sticks, else 0, so that the
        first is to be no smaller than 0, nor than the length of the other two.
        """
        directions = _along(forces - self._normal_part(forces))
        by_need, by_force = self._operators(states, directions, forces, velocities)
        seen = np.zeros_like(by_need)
        friction = self._surfaces.friction
        for point, normal in enumerate(self._normals):
            own = slice(3 * point, 3 * point + 3)
            seen[3 * point, own] = normal
            if states[point] == STICKING and friction[point] > 0:
                seen[3 * point + 1 : 3 * point + 3, own] = _across(normal) / friction[point]
        return by_need, by_force, seen

    def _normal_part(self, forces: Array) -> Array:
        normals = self._normals
        part: Array = normals * np.einsum("ij,ij->i", normals, forces)[:, np.newaxis]
        return part

    def _operators(
        self, states: Array, directions: Array, forces: Array, velocities: Array
    ) -> tuple[Array, Array]:
        """Return the matrices, (3 m, 3 m), by which D is linear in (t n - free) / h and in F."""
        rows, columns, shares, soft = self._blocks(states, directions, forces, velocities)
        w = self._compliance
        by_need: Array = 0 * w
        if columns.size:
            by_need = columns @ np.linalg.solve(rows.T @ (w + soft) @ columns, rows.T)
        beyond = shares - np.eye(len(w))
        by_force: Array = beyond - by_need @ (soft @ shares + w @ beyond)
        return by_need, by_force

    def _blocks(
        self, states: Array, directions: Array, forces: Array, velocities: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Return E, C, P and S / h; those of each point are 3 x 3."""
        m, normals = len(states), self._normals
        friction = self._surfaces.friction
        unit = np.eye(3)
        is_sliding = states == SLIDING
        across = np.cross(normals, directions)
        # columns of E and C at each point, and which of them there are
        rows, columns = np.zeros((2, m, 3, 3))
        rows[:] = columns[:] = unit
        rows[is_sliding] = columns[is_sliding] = 0.0
        pressing = normals + friction[:, np.newaxis] * directions
        rows[is_sliding, :, 0], columns[is_sliding, :, 0] = (
            normals[is_sliding],
            pressing[is_sliding],
        )
        turns = is_sliding & (friction > 0)
        rows[turns, :, 1] = columns[turns, :, 1] = across[turns]
        kept = np.ones((m, 3), dtype=bool)
        kept[is_sliding, 2] = False
        kept[is_sliding & ~turns, 1] = False
        kept[states == OPEN] = False
        # P: what of F is kept
        shares = np.zeros((m, 3, 3))
        shares[states == STICKING] = unit
        shares[is_sliding] = _outer(pressing, normals)[is_sliding]
        shares[turns] += _outer(across, across)[turns]
        soft = self._surfaces.compliance[:, np.newaxis, np.newaxis] * _outer(normals, normals)
        if turns.any():
            tangent = velocities - self._normal_part(velocities)
            speed = np.sqrt(np.einsum("ij,ij->i", tangent, tangent))
            limit = friction * np.einsum("ij,ij->i", normals, forces)
            turning = np.divide(speed, limit, out=np.zeros(m), where=turns & (limit > 0))
            soft += turning[:, np.newaxis, np.newaxis] * _outer(across, across)
        e, c, p, s = (_diagonal(one) for one in (rows, columns, shares, soft / self._step))
        flags = kept.ravel()
        return e[:, flags], c[:, flags], p, s

    def solve(
        self, states: Array, forces: Array, velocities: Array, free: Array, target: Array
    ) -> Array | None:
        """Return D, (3 m,), with points opened and slid until no law is broken; None if it fails.

        `free`, (m, 3), are relative velocities at the end of the step for D = 0, and `target`,
        (m,), is t.
        """
        need = (self._normals * target[:, np.newaxis] - free).ravel() / self._step
        states = states.copy()
        normals, friction = self._normals, self._surfaces.friction
        flat, h = forces.ravel(), self._step
        directions = _along(forces - self._normal_part(forces))
        for _ in range(ROUNDS):
            rows, columns, shares, soft = self._blocks(states, directions, forces, velocities)
            kept = shares.dot(flat)
            change: Array = kept - flat
            if columns.size:
                right = need - soft.dot(kept) - self._compliance.dot(change)
                matrix = rows.T @ (self._compliance + soft) @ columns
                change += columns.dot(np.linalg.solve(matrix, rows.T.dot(right)))
            whole = forces + change.reshape(-1, 3)
            normal = np.einsum("ij,ij->i", normals, whole)
            tangent = whole - normals * normal[:, np.newaxis]
            size = np.sqrt(np.einsum("ij,ij->i", tangent, tangent))
            pulls = (states != OPEN) & (normal < -SIGN * (1 + np.abs(flat).max()))
            slips = (states == STICKING) & (size > friction * normal * (1 + LIMIT) + 1e-12) & ~pulls
            # friction that would push a point the way it goes does not slide
            coming = free + h * self._compliance.dot(change).reshape(-1, 3)
            along = np.einsum("ij,ij->i", coming, directions)
            sticks = (states == SLIDING) & (friction > 0) & (along > SIGN) & ~pulls
            if not (pulls.any() or slips.any() or sticks.any()):
                return change
            states[pulls], states[slips], states[sticks] = OPEN, SLIDING, STICKING
            directions[slips] = _along(tangent[slips])
        return None


def _along(vectors: Array) -> Array:
    """Return unit vectors, (m, 3); 0 where there is no direction."""
    sizes = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, np.newaxis]
    unit: Array = np.divide(vectors, sizes, out=np.zeros_like(vectors), where=sizes > 0)
    return unit


def _across(normal: Array) -> Array:
    """Return two unit vectors across a unit vector and each other, (2, 3)."""
    least = np.zeros(3)
    least[np.argmin(np.abs(normal))] = 1.0
    first = np.cross(normal, least)
    first /= np.sqrt(first.dot(first))
    return np.array((first, np.cross(normal, first)))


def _outer(one: Array, other: Array) -> Array:
    """Return the products of vectors, (m, 3) and (m, 3), as matrices, (m, 3, 3)."""
    product: Array = one[:, :, np.newaxis] * other[:, np.newaxis]
    return product


def _diagonal(blocks: Array) -> Array:
    """Return blocks, (m, 3, 3), on the diagonal of a matrix, (3 m, 3 m)."""
    m = len(blocks)
    matrix: Array = np.zeros((m, 3, m, 3))
    points = np.arange(m)
    matrix[points, :, points] = blocks
    square: Array = matrix.reshape(3 * m, 3 * m)
    return square
