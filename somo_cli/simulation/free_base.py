"""A body whose base is free: its base, too, feels Coriolis forces half a step too early."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.runner import Runner
from somo_cli.simulation.springs import Array
from somo_cli.simulation.world import WorldBody


class FreeRunner(Runner):
    """One body with a free base in motion; see `Runner`.

    The correction has a part for the joints and a wrench for the base. The law knows what of it
    the joints feel; the rest is added to its torques, and the wrench is applied to the base.
    Without it the momentum of a body in free flight would drift with the first order of the step;
    it is renewed in every step, because what holding costs would add up in the momentum.
    """

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        self._spin: Array = np.array(body.start.angular_velocity)
        self._previous_spin = self._spin
        super().__init__(plan, body, world_body)

    def begin(self, force: Array, rates: Array) -> None:
        """Take the force measured at the start, and let the spin half a step on be the start's."""
        super().begin(force, rates)
        self._previous_spin = 3 * self._spin - 2 * np.array(self.body.start.angular_velocity)

    def _make_pull(self) -> Callable[[], None]:
        pull_joints = super()._make_pull()

        def pull() -> None:
            pull_joints()
            self._previous_spin = self._spin
            self._spin = np.array(self.world_body.base_velocity()[1])

        return pull

    def _is_calm(self, last_correction: Array) -> bool:
        return False

    def _push_corrected(self) -> None:
        law, world = self.law, self.world_body
        angles = law.angles.tolist()
        coming_spin = (1.5 * self._spin - 0.5 * self._previous_spin).tolist()
        present = world.bias(angles, law.rates.tolist(), self._spin.tolist())
        change: Array = np.zeros_like(present)

        def felt_at(rates: Array) -> Array:
            coming = world.bias(angles, rates.tolist(), coming_spin)
            np.subtract(present, coming, change)
            return world.felt_by_joints(coming)

        torques = law.correct(world.felt_by_joints(present), felt_at)
        beyond = change[6:] - world.felt_by_joints(change)
        world.push_base(change[:6])
        world.apply((beyond + torques).tolist())
