"""Joint limits within the implicit laws: the torques with which joints stop where they must.

The engine stops a joint only once it is beyond its limit, and the law would take the blow for a
force that lasts: in the next step it would push back by B (M + B)⁻¹ of it, into the limit, and
several stiff joints together overran their limits by more than half a radian. So the law looks
ahead and has the joints stop by a torque of its own, which is part of what it applies.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.chain import Joint

LIMIT_ERP = 0.2  # of how far a joint is beyond its limit, in each step; as the engine's own
BLOCK_PIVOTS = 8  # at once, before they are taken one by one, which cannot go round in circles


class JointLimits:
    """Limits [rad] of the joints of a chain, infinite where there are none."""

    def __init__(self, joints: Sequence[Joint]) -> None:
        limited = [joint.is_limited for joint in joints]
        self.lower: Array = np.where(limited, [joint.lower for joint in joints], -np.inf)
        self.upper: Array = np.where(limited, [joint.upper for joint in joints], np.inf)

    def clearance(self, angles: Array) -> float:
        """Return how far the joint that is nearest to a limit is from it [rad]."""
        return float(np.minimum(self.upper - angles, angles - self.lower).min())

    def torques(
        self, time_step: float, angles: Array, rates: Array, acceleration: Array, response: Array
    ) -> Array | None:
        """Return the torques on joints that would pass their limits in this step, else None.

        `acceleration` is what the law would do without, and `response`, (n, n), what it adds to
        that for torques. They are the least that hold, and push inwards only.
        """
        above, below = self.upper - angles, self.lower - angles
        coming = time_step * (rates + time_step * acceleration)
        if not np.minimum(above - coming, coming - below).min() < 0:
            return None
        np.multiply(above, LIMIT_ERP, out=above, where=above < 0)
        np.multiply(below, LIMIT_ERP, out=below, where=below > 0)
        highest, lowest = ((angle / time_step - rates) / time_step for angle in (above, below))
        return limit_torques(acceleration, response, lowest, highest)


def limit_torques(acceleration: Array, response: Array, lowest: Array, highest: Array) -> Array:
    """Return torques t, (n,), that bring a + R t between two bounds and act at bounds only.

    R is positive definite, so there is one answer. By pivoting: Cottle, Pang, Stone, The Linear
    Complementarity Problem (1992), ch. 4.2.
    """
    n = len(acceleration)
    torques: Array = np.zeros(n)
    side = np.zeros(n, dtype=np.int64)  # 1 where held at the highest, -1 at the lowest
    for pivot in range(BLOCK_PIVOTS + 50 * n):
        held = np.flatnonzero(side)
        torques[:] = 0.0
        bounds = np.where(side > 0, highest, lowest)[held]
        torques[held] = np.linalg.solve(response[np.ix_(held, held)], bounds - acceleration[held])
        reached = acceleration + response.dot(torques)
        wanted = np.where(reached > highest, 1, np.where(reached < lowest, -1, 0))
        # one that is held stays so while it is pushed inwards
        wanted[held] = np.where(torques[held] * side[held] < 0, side[held], 0)
        wrong = np.flatnonzero(wanted != side)
        if len(wrong) == 0:
            break
        if pivot >= BLOCK_PIVOTS:
            wrong = wrong[-1:]
        side[wrong] = wanted[wrong]
    return torques
