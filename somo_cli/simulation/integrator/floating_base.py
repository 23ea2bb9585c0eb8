"""A body whose base is free: its base, too, feels Coriolis forces half a step too early."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.engine.interface import WorldBody
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.implicit_law import SMOOTH, limited_change
from somo_cli.simulation.plan.model import Body, Plan


class FloatingBaseStepper(BodyStepper):
    """One body with a free base in motion; see `BodyStepper`.

    The correction has a part for the joints and a wrench for the base. The law knows what of it
    the joints feel; the rest is added to its torques, and the wrench is applied to the base.
    Without it the momentum of a body in free flight would drift with the first order of the step;
    it is renewed in every step, because what holding costs would add up in the momentum.
    Loads act in the same two parts.
    """

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        self._spin: Array = np.array(body.start.angular_velocity)
        self._previous_spin = self._spin
        self._spin_change: Array = np.zeros(3)  # by how much the spin changed in the last step
        self._velocity: Vector = body.start.linear_velocity  # of the base's centre of mass
        self._load: Array = np.zeros(6 + len(body.chain.joints))
        # of the loads: on the base, in its own axes, and on the joints beyond what the law knows
        self._base_wrench: Array = np.zeros(6)
        self._residual_torques: Array = np.zeros(len(body.chain.joints))
        self._ahead: tuple[Array, Pose] = np.zeros(0), Pose()  # correction on all, and centre
        super().__init__(plan, body, world_body)
        self._working_torques = self.actuation

    def set_start_force(self, force: Array, rates: Array) -> None:
        """Take the force measured at the start, and let the spin half a step on be the start's."""
        super().set_start_force(force, rates)
        self._previous_spin = 3 * self._spin - 2 * np.array(self.body.start.angular_velocity)
        self._spin_change = self._spin - self._previous_spin

    def _make_read_state(self) -> Callable[[], None]:
        read_joints = super()._make_read_state()

        def read_state() -> None:
            read_joints()
            self._previous_spin = self._spin
            self._velocity, spin = self.world_body.base_velocity()
            self._spin = np.array(spin)

        return read_state

    def _apply_load(self, load: Array) -> None:
        self._load = load
        own = self.world_body.to_base_axes(load)
        joint_torques = self.world_body.equivalent_joint_torques(own)
        np.add(self.actuation, joint_torques, self.law.actuation)
        self._base_wrench, self._residual_torques = own[:6], own[6:] - joint_torques

    def count_step_work(self) -> None:
        """Count the work of the last step; loads act on the base as well."""
        super().count_step_work()
        if self.loads is not None:
            motion = [*self._spin, *self._velocity, *self._rates]
            self._step_powers += self._load.dot(motion)

    def _update_energy(self) -> None:
        super()._update_energy()
        law, base = self.law, self.world_body.base_pose()
        if not law.detects_impacts:
            moved = geometry.subtract(base.position, self.body.start.position)
            self.energy.bound_base_fall(geometry.norm(moved))
            return
        pose = self.dynamics().at(law.angles, base)
        velocity, spin = self.world_body.base_velocity()
        kinetic = pose.kinetic_energy([*spin, *velocity, *law.rates])
        self.energy.set_whole_energy(kinetic, pose.gravity_energy(self._gravity))

    def gravity_work(self) -> float:
        """Return nothing: the energy of the whole body counts it."""
        return 0.0

    def apply(self, torques: Sequence[float]) -> None:
        """Apply torques of the law, and what of the loads the law cannot know."""
        if self.loads is not None:
            self.world_body.apply_base_wrench(self._base_wrench)
            torques = (self._residual_torques + torques).tolist()
        self.world_body.apply(torques)

    def _make_apply_reused(self) -> Callable[[], None]:
        return self.law.make_reuse(self.apply)

    def _reuse_steps(self, change: Array) -> int:
        return 1

    def _predict_corrected(self) -> None:
        law, world = self.law, self.world_body
        angles = law.angles.tolist()
        spin_change = self._spin - self._previous_spin
        if law.detects_impacts:
            spin_change, self._spin_change = (
                limited_change(spin_change, self._spin_change, SMOOTH / law.time_step),
                spin_change,
            )
        coming_spin = (self._spin + 0.5 * spin_change).tolist()
        centre = world.base_inertial_pose()
        present = world.bias(angles, law.rates.tolist(), self._spin.tolist(), centre)
        change: Array = np.empty(len(present))

        def joint_bias_at(rates: Array) -> Array:
            coming = world.bias(angles, rates.tolist(), coming_spin, centre)
            np.subtract(present, coming, change)
            return world.equivalent_joint_torques(coming)

        law.predict(world.equivalent_joint_torques(present), joint_bias_at)
        self._ahead = change, centre

    def _finish_corrected(self, change: Array | None = None) -> None:
        law, world = self.law, self.world_body
        ahead, centre = self._ahead
        torques = law.settle(change)
        residual_torques = ahead[6:] - law.correction  # of which the law knows what the joints feel
        wrench = ahead[:6]
        if self.loads is not None:
            wrench += self._base_wrench
            residual_torques += self._residual_torques
        world.apply_base_wrench(wrench, centre)
        world.apply((residual_torques + torques).tolist())
