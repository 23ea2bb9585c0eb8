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

All vectors are in axes of their point: its normal, then two across it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array, invert

ROUNDS = 8  # of solving anew: almost always one or two are enough
LIMIT = 1e-5  # relative: friction as near to its limit slides
SIGN = 1e-9  # relative: a normal force that is smaller, and negative, does not pull
REGULAR = 1e-3  # of the mean compliance: see above

STICKING, SLIDING, OPEN = 0, 1, 2

Direction = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Surfaces:
    """Of each point: coefficient of friction, recovery, and normal compliance, shape (m,) each."""

    friction: Array
    recovery: Array
    compliance: Array


class ContactProblem:
    """The problem at points that stay the same for a few steps.

    `states` below tell which points stick and which slide, m of them; `forces`, (3 m,), are F, and
    `velocities`, (3 m,), relative velocities of first to second now.
    """

    def __init__(self, compliance: Array, surfaces: Surfaces, step: float) -> None:
        """Take W, (3 m, 3 m), which is positive semidefinite, and the step h [s]."""
        size = len(compliance)
        self._compliance = compliance.copy()
        diagonal = self._compliance.reshape(-1)[:: size + 1]
        self._scale = float(diagonal.sum()) / size  # of rows that hold no compliance
        diagonal += REGULAR * self._scale
        self._soft = (surfaces.compliance / step).tolist()
        self._sticking = self._compliance.copy()  # the matrix of the equations where all stick
        self._sticking.reshape(-1)[:: 3 * (size + 1)] += surfaces.compliance / step
        self._friction: list[float] = surfaces.friction.tolist()
        self._step = step

    def operators(
        self, states: Sequence[int], forces: Array, velocities: Array
    ) -> tuple[Array, Array]:
        """Return K and L, (3 m, 3 m) each: D = K (t n - free) / h + L F where no state changes."""
        flat = forces.tolist()
        directions = [_along(*flat[at : at + 2]) for at in range(1, len(flat), 3)]
        dampings = self._dampings(states, flat, velocities.tolist())
        inverse = invert(self._matrix(states, directions, dampings))
        by_need, by_force = inverse.copy(), np.zeros_like(inverse)
        for point, (state, soft) in enumerate(zip(states, self._soft, strict=True)):
            normal, one, two = range(3 * point, 3 * point + 3)
            if soft:
                by_force[:, normal] = -soft * inverse[:, normal]
            if state == SLIDING:
                a, b = directions[point]
                across, limit = inverse[:, one], self._scale * inverse[:, two]
                moves = float(self._friction[point] > 0)
                by_need[:, one], by_need[:, two] = -b * moves * across, a * moves * across
                by_force[:, normal] += self._friction[point] * limit
                turn = dampings[point] * across
                by_force[:, one] = b * turn - a * limit
                by_force[:, two] = -a * turn - b * limit
        return by_need, by_force

    def solve(
        self,
        states: Sequence[int],
        forces: Array,
        velocities: Array,
        free: Array,
        target: Array,
    ) -> Array | None:
        """Return D, (3 m,), with points opened and slid until no law is broken; None if it fails.

        `free`, (3 m,), are relative velocities at the end of the step for D = 0, and `target`,
        (m,), is t.
        """
        need = -free
        need[::3] += target
        need /= self._step
        states, flat = list(states), forces.tolist()
        dampings = self._dampings([SLIDING] * len(states), flat, velocities.tolist())
        directions = [_along(*flat[at : at + 2]) for at in range(1, len(flat), 3)]
        least = -SIGN * (1 + max(flat, default=0.0))
        for _ in range(ROUNDS):
            matrix = self._matrix(states, directions, dampings)
            right = self._right_side(states, directions, dampings, flat, need.tolist())
            change: Array = invert(matrix).dot(right)
            coming = free + self._step * self._compliance.dot(change)
            found = (forces + change).tolist(), coming.tolist()
            if not self._changes_states(states, directions, *found, least):
                return change
        return None

    def _dampings(
        self, states: Sequence[int], forces: Sequence[float], velocities: Sequence[float]
    ) -> list[float]:
        """Return e of points that slide; without friction, what makes F + D none along p."""
        found = []
        for point, (state, friction) in enumerate(zip(states, self._friction, strict=True)):
            damping = 0.0
            if state == SLIDING:
                damping = self._scale
                limit = friction * forces[3 * point]
                if friction > 0:
                    speed = math.hypot(*velocities[3 * point + 1 : 3 * point + 3])
                    damping = speed / (limit * self._step) if limit > 0 else 0.0
            found.append(damping)
        return found

    def _matrix(
        self, states: Sequence[int], directions: Sequence[Direction], dampings: Sequence[float]
    ) -> Array:
        """Return the matrix of the equations for D; those of d come last of a point that slides."""
        matrix = self._sticking.copy()
        scale = self._scale
        for point, state in enumerate(states):
            if state == STICKING:
                continue
            normal, one, two = range(3 * point, 3 * point + 3)
            if state == OPEN:
                matrix[normal : two + 1] = 0.0
                matrix[normal, normal] = matrix[one, one] = matrix[two, two] = scale
                continue
            a, b = directions[point]
            friction, damping = self._friction[point], dampings[point]
            if friction > 0:
                matrix[one] = a * matrix[two] - b * matrix[one]
            else:
                matrix[one] = 0.0
            matrix[one, one] -= b * damping
            matrix[one, two] += a * damping
            matrix[two] = 0.0
            matrix[two, normal : two + 1] = -friction * scale, a * scale, b * scale
        return matrix

    def _right_side(
        self,
        states: Sequence[int],
        directions: Sequence[Direction],
        dampings: Sequence[float],
        forces: Sequence[float],
        need: Sequence[float],
    ) -> list[float]:
        """Return the right side of the equations for D, 3 m numbers; `need` is (t n - free) / h."""
        right: list[float] = []
        for point, state in enumerate(states):
            at = 3 * point
            (force, one, two), (gap, u, w) = forces[at : at + 3], need[at : at + 3]
            if state == OPEN:
                right += -self._scale * force, -self._scale * one, -self._scale * two
                continue
            right.append(gap - self._soft[point] * force)
            if state == STICKING:
                right += u, w
                continue
            (a, b), friction = directions[point], self._friction[point]
            asked = a * w - b * u if friction > 0 else 0.0
            right.append(asked - dampings[point] * (a * two - b * one))
            right.append(self._scale * (friction * force - a * one - b * two))
        return right

    def _changes_states(
        self,
        states: list[int],
        directions: list[Direction],
        whole: Sequence[float],
        coming: Sequence[float],
        least: float,
    ) -> bool:
        """Change the states of points that break a law; whether any did.

        `whole`, 3 m numbers, is F + D, `coming` are the velocities that it leads to.
        """
        changed = False
        for point, (state, friction) in enumerate(zip(states, self._friction, strict=True)):
            at = 3 * point
            normal, one, two = whole[at : at + 3]
            if state == OPEN:
                continue
            if normal < least:
                states[point] = OPEN
            elif state == STICKING:
                if math.hypot(one, two) <= friction * normal * (1 + LIMIT) + 1e-12:
                    continue
                states[point], directions[point] = SLIDING, _along(one, two)
            else:
                # friction that would push a point the way it goes does not slide
                a, b = directions[point]
                if friction == 0 or a * coming[at + 1] + b * coming[at + 2] <= SIGN:
                    continue
                states[point] = STICKING
            changed = True
        return changed


def _along(one: float, two: float) -> Direction:
    """Return a unit vector, the first axis where there is no direction."""
    size = math.hypot(one, two)
    return (one / size, two / size) if size > 0 else (1.0, 0.0)
