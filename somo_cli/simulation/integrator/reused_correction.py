"""The law with its last correction extrapolated: in most steps one product of vector and matrix.

The torques τ = s - B (M + B)⁻¹ (f + s), and a likewise, are linear in the state that `law_state`
stacks. Its first two numbers stand for the correction: the share of its growth that acts by now,
larger in every step, and a one, whose row holds what does not change until the next correction.
"""

from __future__ import annotations

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.law_state import blocks


class ReusedCorrection:
    """Gives the torques of a law without asking for bias forces; engine units."""

    def __init__(self, law: SpringDamperLaw) -> None:
        n = len(law.rates)
        self._law = law
        self.state = law.state
        self._springs_at_rest: Array = law.springs.stiffness * law.springs.neutral
        self._negative_stiffness: Array = -law.springs.stiffness[:, np.newaxis]
        self._unit: Array = np.eye(n)
        self._spring_by_rates = blocks(law.spring_map[1:], 3)[2]
        self._force_by_rates, self._force_by_previous, _ = blocks(law.force_map, 3)
        self.torque_map: Array = np.zeros((5 * n + 2, n))
        """The torques as a linear function of the state, a row for each number of it."""
        self.torque_map[1 : 3 * n + 2] = law.spring_map  # all that the explicit law has
        self._growth_row, self._constant_row = self.torque_map[:2]
        self._torque_blocks = blocks(self.torque_map[2:], 5)
        self._acceleration_map: Array = np.zeros((5 * n + 2, n))
        self._acceleration_blocks = blocks(self._acceleration_map[2:], 5)
        # the (M + B)⁻¹ for which each map was assembled
        self._torques_of: Array | None = None
        self._acceleration_of: Array | None = None
        self._extrapolated: tuple[Array, Array] | None = None  # not yet in the acceleration
        self._growth_per_step = 1.0

    def extrapolate(self, bias_decrease: Array, growth: Array, steps: int) -> None:
        """Extrapolate the last correction over the coming steps; comes first after each new M.

        `bias_decrease` is the decrease of the bias forces over so many steps, shape (n,): the
        measured force is a step old, and too large by a step's share of it. `growth` is the change
        of the correction over the steps.
        """
        if self._torques_of is not self._law.response:
            self._assemble_torque_map()
        by_actuation = self._torque_blocks[0]
        lag = bias_decrease / steps
        ahead = lag + self._springs_at_rest
        ahead += self._law.correction
        np.subtract(ahead.dot(by_actuation), lag, self._constant_row)
        growth.dot(by_actuation, self._growth_row)
        self._extrapolated = ahead, growth
        self._growth_per_step, self.state.growth_share[0] = 1 / steps, 0.0

    def torques(self) -> list[float]:
        """Return the torques of the coming step; a run spends its time here."""
        state = self.state
        state.growth_share[0] += self._growth_per_step
        state.vector.dot(self.torque_map, state.torques)
        state.advance()
        self._law.bias = None
        values: list[float] = state.torques.tolist()
        return values

    def predict(self) -> None:
        """Have the law predict the coming step with the correction as `torques` has it."""
        self.state.growth_share[0] += self._growth_per_step
        if self._extrapolated is not None:
            self._assemble_acceleration_map(*self._extrapolated)
            self._extrapolated = None
        self._law.predict_linearly(self._acceleration_map, self.torque_map)

    def _assemble_torque_map(self) -> None:
        """Assemble the one matrix for the present M; it pays where it serves several steps."""
        response = self._law.response
        by_actuation, by_angles, by_rates, by_previous, by_torques = self._torque_blocks
        # transposed, so in reverse order: B (M + B)⁻¹ and 1 - B (M + B)⁻¹
        share = response.dot(self._law.implicit, by_torques)
        rest = np.subtract(self._unit, share, by_actuation)
        np.multiply(self._negative_stiffness, rest, by_angles)
        self._force_by_rates.dot(share, by_previous)
        self._spring_by_rates.dot(rest, by_rates)
        np.subtract(by_rates, by_previous, by_rates)
        self._torques_of = response

    def _assemble_acceleration_map(self, ahead: Array, growth: Array) -> None:
        """Assemble a as a linear function of the state, with an extrapolated correction."""
        response, rows = self._law.response, self._acceleration_map
        if self._acceleration_of is not response:
            self._acceleration_of = response
            by_actuation, by_angles, by_rates, by_previous, by_torques = self._acceleration_blocks
            by_actuation[:] = response
            np.multiply(self._negative_stiffness, response, by_angles)
            np.add(self._spring_by_rates, self._force_by_rates).dot(response, by_rates)
            self._force_by_previous.dot(response, by_previous)
            np.negative(response, by_torques)
        growth.dot(response, rows[0])
        ahead.dot(response, rows[1])
