"""The change of contact forces that the coming step brings: a small linear problem with signs.

Forces F, (m, 3), act at m points. A change D of them changes the relative velocities there, over
the coming step h, by h W D. Let `free` be the relative velocities at its end for D = 0, n the
normals, g the gaps. As the engine does, the step brings each point that sticks to

    v = t n,  t = -g/h where there is a gap, else -r g/h with the recovery r,

and in points that slide the friction is mu times the normal force, against the velocity: along the
direction d of F as it is, and across it, p = n x d, as if it were a damper mu N / |v|, which turns
the force with the velocity. A soft surface of stiffness k and damping c adds the normal
compliance 1 / (h k + c) and makes r = h k / (h k + c), which is the implicit spring and damper.
With s the normal compliance over h, and e that of the damper, |v| / (mu N h), of points that slide,

    n . (W D + (t n - free) / -h) + s n . (F + D) = 0,       and, where a point sticks,
    the same without s for both tangents; where it slides,
    p . (W D + (t n - free) / -h) + e p . (F + D) = 0  and  d . (F + D) = mu n . (F + D).

No force pulls, and those that stick are no larger than mu N: points that would break this are
opened, or slide, and the problem is solved anew. Duriez and others, IEEE TVCG 12 (2006) 36, predict
contact with the compliance of implicit steps likewise; here what changes is predicted, so that
equilibria stay those of the engine.

Where more points press than hold a body, as those of two faces, W is singular and what the points
ask for need not be possible. So W is made a little larger on its diagonal: with 1e-10 of its mean
fingers that held a cube by two points each threw it away, from 1e-4 to 1e-2 all is well. It takes
a share off the change where many points share it, and nothing off equilibria, which have none.

All vectors are in axes of their point: its normal, then two across it. Points without friction
have the normal alone. `rows_of_points` tells which rows of all (3 m) that leaves.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array, invert
from somo_cli.simulation.dynamics.link_frames import IntArray
from somo_cli.simulation.integrator.contact_states import (
    OPEN,
    SIGN,
    SLIDING,
    Direction,
    PointStates,
    along,
)

ROUNDS = 8  # of solving anew: almost always one or two are enough
REGULAR = 1e-3  # of the mean compliance: see above


@dataclass(frozen=True, slots=True)
class Surfaces:
    """Of each point: coefficient of friction, recovery, and normal compliance, shape (m,) each."""

    friction: Array
    recovery: Array
    compliance: Array


class ContactProblem:
    """The problem at points that stay the same for a few steps.

    `states` below tell which points stick and which slide, m of them; `forces`, (rows,), are F, and
    `velocities`, (rows,), relative velocities of first to second now.
    """

    def __init__(self, compliance: Array, surfaces: Surfaces, step: float) -> None:
        """Take W, (rows, rows), which is positive semidefinite, and the step h [s]."""
        size = len(compliance)
        self._friction: list[float] = surfaces.friction.tolist()
        widths = [3 if friction > 0 else 1 for friction in self._friction]
        self.normals = list(itertools.accumulate(widths, initial=0))[:-1]
        """The rows of the normals."""
        self._states = PointStates(self.normals, self._friction)
        self._rubbing = [
            (point, at, friction)
            for point, (at, friction) in enumerate(zip(self.normals, self._friction, strict=True))
            if friction > 0
        ]
        self._compliance = compliance.copy()
        diagonal = self._compliance.reshape(-1)[:: size + 1]
        self._scale = float(diagonal.sum()) / size  # of rows that hold no compliance
        diagonal += REGULAR * self._scale
        self._soft: Array = surfaces.compliance / step
        self._sticking = self._compliance.copy()  # the matrix of the equations where all stick
        self._sticking[self.normals, self.normals] += self._soft
        self._step = step

    def operators(
        self, states: Sequence[int], forces: Array, velocities: Array
    ) -> tuple[Array, Array]:
        """Return K and L, (rows, rows): D = K (t n - free) / h + L F where no state changes."""
        flat = forces.tolist()
        directions = self._directions(flat)
        dampings = self._dampings(flat, velocities.tolist())
        inverse = invert(self._matrix(states, directions, dampings))
        by_need, by_force = inverse.copy(), np.zeros_like(inverse)
        by_force[:, self.normals] = -self._soft * inverse[:, self.normals]
        for point, at, friction in self._rubbing:
            if states[point] == SLIDING:
                a, b = directions[point]
                across, limit = inverse[:, at + 1], self._scale * inverse[:, at + 2]
                by_need[:, at + 1], by_need[:, at + 2] = -b * across, a * across
                by_force[:, at] += friction * limit
                turn = dampings[point] * across
                by_force[:, at + 1] = b * turn - a * limit
                by_force[:, at + 2] = -a * turn - b * limit
        return by_need, by_force

    def solve(
        self,
        states: Sequence[int],
        forces: Array,
        velocities: Array,
        free: Array,
        target: Array,
    ) -> Array | None:
        """Return D, (rows,), with points opened and slid until no law is broken; None if it fails.

        `free`, (rows,), are relative velocities at the end of the step for D = 0, and `target`,
        (m,), is t.
        """
        need = -free
        need[self.normals] += target
        need /= self._step
        states, flat = list(states), forces.tolist()
        dampings = self._dampings(flat, velocities.tolist())
        directions = self._directions(flat)
        least = -SIGN * (1 + max(flat, default=0.0))
        for _ in range(ROUNDS):
            matrix = self._matrix(states, directions, dampings)
            right = self._right_side(states, directions, dampings, forces, need)
            change: Array = invert(matrix).dot(right)
            coming = free + self._step * self._compliance.dot(change)
            found = (forces + change).tolist(), coming.tolist()
            if not self._states.change(states, directions, *found, least):
                return None if math.isnan(found[0][0]) else change
        return None

    def _directions(self, forces: Sequence[float]) -> dict[int, Direction]:
        """Return d of points with friction."""
        return {point: along(forces[at + 1], forces[at + 2]) for point, at, _ in self._rubbing}

    def _dampings(self, forces: Sequence[float], velocities: Sequence[float]) -> dict[int, float]:
        """Return e of points with friction, where they slide."""
        found = {}
        for point, at, friction in self._rubbing:
            limit = friction * forces[at]
            speed = math.hypot(velocities[at + 1], velocities[at + 2])
            found[point] = speed / (limit * self._step) if limit > 0 else 0.0
        return found

    def _matrix(
        self,
        states: Sequence[int],
        directions: Mapping[int, Direction],
        dampings: Mapping[int, float],
    ) -> Array:
        """Return the matrix of the equations for D; those of d come last of a point that slides."""
        matrix = self._sticking.copy()
        scale = self._scale
        for point, at, friction in self._rubbing:
            if states[point] == SLIDING:
                (a, b), damping = directions[point], dampings[point]
                matrix[at + 1] = a * matrix[at + 2] - b * matrix[at + 1]
                matrix[at + 1, at + 1] -= b * damping
                matrix[at + 1, at + 2] += a * damping
                matrix[at + 2] = 0.0
                matrix[at + 2, at : at + 3] = -friction * scale, a * scale, b * scale
        for row in self._open_rows(states):
            matrix[row] = 0.0
            matrix[row, row] = scale
        return matrix

    def _right_side(
        self,
        states: Sequence[int],
        directions: Mapping[int, Direction],
        dampings: Mapping[int, float],
        forces: Array,
        need: Array,
    ) -> Array:
        """Return the right side of the equations for D, (rows,); `need` is (t n - free) / h."""
        right = need.copy()
        right[self.normals] -= self._soft * forces[self.normals]
        for point, at, friction in self._rubbing:
            if states[point] == SLIDING:
                a, b = directions[point]
                force, one, two = forces[at : at + 3].tolist()
                asked = a * need[at + 2] - b * need[at + 1]
                right[at + 1] = asked - dampings[point] * (a * two - b * one)
                right[at + 2] = self._scale * (friction * force - a * one - b * two)
        for row in self._open_rows(states):
            right[row] = -self._scale * forces[row]
        return right

    def _open_rows(self, states: Sequence[int]) -> Iterator[int]:
        """Yield the rows of points that do not press any more."""
        for at, state, friction in zip(self.normals, states, self._friction, strict=True):
            if state == OPEN:
                yield from range(at, at + (3 if friction > 0 else 1))


def rows_of_points(friction: Array) -> IntArray:
    """Return the rows, of three for each point, that the problem has: of some the normal alone."""
    kept = np.ones((len(friction), 3), dtype=bool)
    kept[friction == 0, 1:] = False
    return np.flatnonzero(kept)
