"""A body whose base is free: its base, too, feels Coriolis forces half a step too early."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.runner import Runner, WorldBody
from somo_cli.simulation.springs import Array


class FreeRunner(Runner):
    """One body with a free base in motion; see `Runner`.

    The correction has a part for the joints and a wrench for the base. The law knows what of it
    the joints feel; the rest is added to its torques, and the wrench is applied to the base.
    Without it the momentum of a body in free flight would drift with the first order of the step.
    """

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        self._spin: Array = np.zeros(3)
        self._previous_spin: Array | None = None
        self._wrench: Array = np.zeros(6)
        self._beyond: Array = np.zeros(len(body.chain.joints))
        super().__init__(plan, body, world_body)

    def _make_pull(self) -> Callable[[], None]:
        pull_joints = super()._make_pull()

        def pull() -> None:
            pull_joints()
            spin = np.array(self.world_body.base_velocity()[1])
            self._previous_spin = self._spin if self._previous_spin is not None else spin
            self._spin = spin

        return pull

    def forget_motion(self) -> None:
        """Take the present spin of the base as that of the step before as well."""
        self._previous_spin = None

    def _make_push_held(self) -> Callable[[], None]:
        hold = self.law.make_hold()

        def push_held() -> None:
            self._apply(hold())

        return push_held

    def _push_corrected(self) -> None:
        law, world = self.law, self.world_body
        angles = law.angles.tolist()
        previous = self._spin if self._previous_spin is None else self._previous_spin
        coming_spin = (1.5 * self._spin - 0.5 * previous).tolist()
        present = world.bias(angles, law.rates.tolist(), self._spin.tolist())
        change: Array = np.zeros_like(present)

        def felt_at(rates: Array) -> Array:
            coming = world.bias(angles, rates.tolist(), coming_spin)
            np.subtract(present, coming, change)
            return world.felt_by_joints(coming)

        torques = law.correct(world.felt_by_joints(present), felt_at)
        self._wrench = change[:6]
        self._beyond = change[6:] - world.felt_by_joints(change)
        self._apply(torques)

    def _apply(self, torques: list[float]) -> None:
        self.world_body.push_base(self._wrench)
        self.world_body.apply((self._beyond + torques).tolist())
