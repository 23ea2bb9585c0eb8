"""The work of actuation and loads on one body, counted for the bound on its energy."""

from __future__ import annotations

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.integrator.fixed_base import FixedBase
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw


class JointWork:
    """Counts work step by step, or at once over steps in which the torques were constant."""

    def __init__(
        self, law: SpringDamperLaw, actuation: Array, base: FixedBase, energy: BodyEnergy
    ) -> None:
        # the law's torques have those of the loads in them, which the base may count itself
        self._torques = actuation if base.counts_load_power else law.actuation
        self._law = law
        self._rates = law.rates
        self._base = base
        self._energy = energy
        self._angles: Array = np.array(base.body.start.angles)  # when work was counted last
        self._powers = 0.0  # summed over the steps since then

    def count_step(self) -> None:
        """Count the work of the last step, in which the joints moved by their rates."""
        self._powers += self._torques.dot(self._rates)
        if self._base.counts_load_power:
            self._powers += self._base.load_power(self._rates)

    def count(self, is_steady: bool) -> None:
        """Add the work done since the last call to the energy bound.

        It was counted step by step, unless the torques were constant (`is_steady`).
        """
        angles = self._law.angles
        if is_steady:
            work = self._torques.dot(angles - self._angles)
        else:
            work = self._law.time_step * self._powers
            self._powers = 0.0
        self._energy.add_work(float(work))
        self._angles[:] = angles
