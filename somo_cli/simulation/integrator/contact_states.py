"""Which contact points stick, slide and open, and how that changes where a law would be broken."""

from __future__ import annotations

import math
from collections.abc import Sequence

LIMIT = 1e-5  # relative: friction as near to its limit slides
SIGN = 1e-9  # relative: a normal force that is smaller, and negative, does not pull

STICKING, SLIDING, OPEN = 0, 1, 2

Direction = tuple[float, float]


class PointStates:
    """The laws of contact at points: no force pulls, and sticking friction is within its cone."""

    def __init__(self, normals: Sequence[int], frictions: Sequence[float]) -> None:
        """Take the row of each point's normal, and its coefficient of friction."""
        self._normals = normals
        self._frictions = frictions

    def change(
        self,
        states: list[int],
        directions: dict[int, Direction],
        whole: Sequence[float],
        coming: Sequence[float],
        least: float,
    ) -> bool:
        """Change the states of points that break a law; whether any did.

        `whole`, as many as rows, is F + D, `coming` are the velocities that it leads to, and
        `least` is the smallest normal force that does not pull.
        """
        changed = False
        for point, (state, at, friction) in enumerate(
            zip(states, self._normals, self._frictions, strict=True)
        ):
            if state == OPEN:
                continue
            if whole[at] < least:
                states[point] = OPEN
                changed = True
            elif friction > 0:
                is_new = self._changes_friction(point, states, directions, whole, coming)
                changed = changed or is_new
        return changed

    def _changes_friction(
        self,
        point: int,
        states: list[int],
        directions: dict[int, Direction],
        whole: Sequence[float],
        coming: Sequence[float],
    ) -> bool:
        """Have a point slide that cannot stick, or stick that would slide backwards."""
        at, friction = self._normals[point], self._frictions[point]
        normal, one, two = whole[at : at + 3]
        if states[point] == STICKING:
            if math.hypot(one, two) <= friction * normal * (1 + LIMIT) + 1e-12:
                return False
            states[point], directions[point] = SLIDING, along(one, two)
            return True
        # friction that would push a point the way it goes does not slide
        a, b = directions[point]
        if a * coming[at + 1] + b * coming[at + 2] <= SIGN:
            return False
        states[point] = STICKING
        return True


def along(one: float, two: float) -> Direction:
    """Return a unit vector, the first axis where there is no direction."""
    size = math.hypot(one, two)
    return (one / size, two / size) if size > 0 else (1.0, 0.0)
