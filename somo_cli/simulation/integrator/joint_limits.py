"""Joint limits within the implicit law: torques that stop joints at their limits.

The engine stops a joint only once it is beyond its limit. The law would take that impact for a
lasting force and, in the next step, push the joint back into the limit by B (M + B)⁻¹ of it;
several stiff joints together overran their limits by more than half a radian. So the law predicts
which joints would pass their limits and stops them by a torque of its own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.chain import Joint

LIMIT_ERP = 0.2  # share of a violation that is corrected in each step, as the engine does
BLOCK_PIVOTS = 8  # rounds of block pivoting before single pivots, which always terminate


class JointLimits:
    """Limits [rad] of the joints of a chain, infinite where there are none."""

    def __init__(self, joints: Sequence[Joint]) -> None:
        limited = [joint.is_limited for joint in joints]
        self.lower: Array = np.where(limited, [joint.lower for joint in joints], -np.inf)
        self.upper: Array = np.where(limited, [joint.upper for joint in joints], np.inf)
        self.were_struck = False
        """Whether a joint would have passed a limit in any step, or was beyond one at a check."""

    def clearance(self, angles: Array) -> float:
        """Return the least distance of a joint from a limit [rad].

        At a limit or beyond it, one was struck: contact can drive a joint there within a step, and
        the engine then stops it.
        """
        least = float(np.minimum(self.upper - angles, angles - self.lower).min())
        self.were_struck = self.were_struck or least <= 0
        return least

    def torques(
        self, time_step: float, angles: Array, rates: Array, acceleration: Array, response: Array
    ) -> Array | None:
        """Return the torques on joints that would pass their limits in this step, else None.

        `acceleration` is that of the law without limits, shape (n,), and `response`, shape (n, n),
        the acceleration per torque. The torques are the least that hold, and push inwards only.
        """
        above, below = self.upper - angles, self.lower - angles
        coming = time_step * (rates + time_step * acceleration)
        if not np.minimum(above - coming, coming - below).min() < 0:
            return None
        self.were_struck = True
        np.multiply(above, LIMIT_ERP, out=above, where=above < 0)
        np.multiply(below, LIMIT_ERP, out=below, where=below > 0)
        highest, lowest = ((angle / time_step - rates) / time_step for angle in (above, below))
        return limit_torques(acceleration, response, lowest, highest)


def limit_torques(acceleration: Array, response: Array, lowest: Array, highest: Array) -> Array:
    """Return torques t, shape (n,), that bring a + R t between two bounds and act only at bounds.

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
