"""A body whose base is free: its base, too, feels Coriolis forces half a step too early."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.engine.interface import WorldBody
from somo_cli.simulation.integrator.body_stepper import Runner
from somo_cli.simulation.integrator.implicit_law import SUDDEN, carried_on
from somo_cli.simulation.plan.model import Body, Plan


class FreeRunner(Runner):
    """One body with a free base in motion; see `Runner`.

    The correction has a part for the joints and a wrench for the base. The law knows what of it
    the joints feel; the rest is added to its torques, and the wrench is applied to the base.
    Without it the momentum of a body in free flight would drift with the first order of the step;
    it is renewed in every step, because what holding costs would add up in the momentum.
    Loads act in the same two parts.
    """

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        self._spin: Array = np.array(body.start.angular_velocity)
        self._previous_spin = self._spin
        self._turned: Array = np.zeros(3)  # by how much the spin changed in the last step
        self._velocity: Vector = body.start.linear_velocity  # of the base's centre of mass
        self._load: Array = np.zeros(6 + len(body.chain.joints))
        # of the loads: on the base, in its own axes, and on the joints beyond what the law knows
        self._wrench: Array = np.zeros(6)
        self._beyond: Array = np.zeros(len(body.chain.joints))
        super().__init__(plan, body, world_body)
        self._acting = self.actuation

    def begin(self, force: Array, rates: Array) -> None:
        """Take the force measured at the start, and let the spin half a step on be the start's."""
        super().begin(force, rates)
        self._previous_spin = 3 * self._spin - 2 * np.array(self.body.start.angular_velocity)
        self._turned = self._spin - self._previous_spin

    def _make_pull(self) -> Callable[[], None]:
        pull_joints = super()._make_pull()

        def pull() -> None:
            pull_joints()
            self._previous_spin = self._spin
            self._velocity, spin = self.world_body.base_velocity()
            self._spin = np.array(spin)

        return pull

    def _carry(self, load: Array) -> None:
        self._load = load
        own = self.world_body.in_base_axes(load)
        felt = self.world_body.felt_by_joints(own)
        np.add(self.actuation, felt, self.law.actuation)
        self._wrench, self._beyond = own[:6], own[6:] - felt

    def count_step(self) -> None:
        """Count the work of the last step; loads act on the base as well."""
        super().count_step()
        if self.loads is not None:
            motion = [*self._spin, *self._velocity, *self._rates]
            self._power += self._load.dot(motion)

    def _account(self) -> None:
        super()._account()
        law, base = self.law, self.world_body.base_pose()
        if not law.can_be_struck:
            moved = geometry.subtract(base.position, self.body.start.position)
            self.energy.let_base_fall(geometry.norm(moved))
            return
        pose = self.dynamics().at(law.angles, base)
        velocity, spin = self.world_body.base_velocity()
        kinetic = pose.kinetic_energy([*spin, *velocity, *law.rates])
        self.energy.take_whole(kinetic, pose.gravity_energy(self._gravity))

    def apply(self, torques: Sequence[float]) -> None:
        """Apply torques of the law, and what of the loads the law cannot know."""
        if self.loads is not None:
            self.world_body.push_base(self._wrench)
            torques = (self._beyond + torques).tolist()
        self.world_body.apply(torques)

    def _make_push_held(self) -> Callable[[], None]:
        return self.law.make_hold(self.apply)

    def _steps_to_hold(self, change: Array) -> int:
        return 1

    def _push_corrected(self) -> None:
        law, world = self.law, self.world_body
        angles = law.angles.tolist()
        turned = self._spin - self._previous_spin
        if law.can_be_struck:
            turned, self._turned = carried_on(turned, self._turned, SUDDEN / law.time_step), turned
        coming_spin = (self._spin + 0.5 * turned).tolist()
        centre = world.centre_pose()
        present = world.bias(angles, law.rates.tolist(), self._spin.tolist(), centre)
        change: Array = np.empty(len(present))

        def felt_at(rates: Array) -> Array:
            coming = world.bias(angles, rates.tolist(), coming_spin, centre)
            np.subtract(present, coming, change)
            return world.felt_by_joints(coming)

        torques = law.correct(world.felt_by_joints(present), felt_at)
        beyond = change[6:] - law.correction  # of which the law knows what the joints feel
        wrench = change[:6]
        if self.loads is not None:
            wrench += self._wrench
            beyond += self._beyond
        world.push_base(wrench, centre)
        world.apply((beyond + torques).tolist())
