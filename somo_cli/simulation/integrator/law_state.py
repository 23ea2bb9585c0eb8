"""The numbers on which the spring-damper law acts, in one vector, so that torques are a product."""

from __future__ import annotations

from typing import Any

import numpy as np

from somo_cli.arrays import Array


class LawState:
    """The state of the n joints of one body, engine units.

    `vector`, shape (5 n + 2,), stacks the share of a reused correction's growth, a one, u, q, v,
    v_prev and τ_prev; the other arrays are views of parts of it, but for `torques`, shape (n,),
    those of the coming step.
    """

    def __init__(self, count: int) -> None:
        n = count
        self.vector: Array = np.zeros(5 * n + 2)
        self.vector[1] = 1.0
        self.growth_share: Any = self.vector[:1].data  # a memory view is written fastest
        self.actuation, self.angles, self.rates, self.previous_rates, self.previous_torques = (
            blocks(self.vector[2:], 5)
        )
        self.motion = self.vector[n + 2 : 3 * n + 2]
        """q, then v."""
        self.of_springs = self.vector[1 : 3 * n + 2]
        """A one, u, q and v, of which s is a linear function."""
        self.of_force = self.vector[2 * n + 2 :]
        """v, v_prev and τ_prev, of which f is a linear function."""
        self.torques: Array = np.zeros(n)
        # memory views are copied in half the time of arrays
        self.present: tuple[Any, Any] = self.rates.data, self.torques.data
        self.previous: tuple[Any, Any] = self.previous_rates.data, self.previous_torques.data

    def advance(self) -> None:
        """Keep the present rates and torques as those of the last step, which comes next."""
        previous_rates, previous_torques = self.previous
        previous_rates[:], previous_torques[:] = self.present


def blocks(rows: Array, count: int) -> list[Array]:
    """Return so many equal parts of an array, one after the other, as views."""
    return np.split(rows, count)
