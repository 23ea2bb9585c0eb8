"""A base that nothing holds: it feels Coriolis forces half a step too early, as joints do."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.external_loads import ExternalLoads
from somo_cli.simulation.engine.interface import WorldBody
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.integrator.fixed_base import BaseVelocity, FixedBase
from somo_cli.simulation.integrator.impacts import SMOOTH, limited_change
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.integrator.spinning_base import SpinningBase
from somo_cli.simulation.plan.model import Body, Plan


class FloatingBase(FixedBase):
    """A base in free motion.

    The correction of Coriolis forces has a part for the joints and a wrench for the base. The law
    knows what of both the joints feel; the rest is added to its torques, and the wrench is applied
    to the base. Without the wrench the momentum of a body in free flight would drift with the first
    order of the step. The correction is refreshed in every step, because the error of reuse would
    add up in the momentum. Loads act in the same two parts.
    """

    energy_includes_base = True

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        super().__init__(body, world_body)
        count = len(body.chain.joints)
        self.counts_load_power = bool(body.loads)
        self.apply = self._apply_with_loads
        self._gravity = plan.gravity
        self._spin: Array = np.array(body.start.angular_velocity)
        self._previous_spin = self._spin
        self._spin_change: Array = np.zeros(3)  # by how much the spin changed in the last step
        self._velocity: Vector = body.start.linear_velocity  # of the base's centre of mass
        self._load: Array = np.zeros(6 + count)
        # of the loads: on the base, in its own axes, and on the joints beyond what the law knows
        self._base_wrench: Array = np.zeros(6)
        self._residual_torques: Array = np.zeros(count)
        self._steps = -1  # predicted so far, less one
        self._spinning = SpinningBase(world_body, plan.time_step, plan.gravity)
        self._predicted: tuple[Array, Pose] = (
            np.zeros(0),
            Pose(),
        )  # correction, (6 + n,), and centre

    def reader(self, read_joints: Callable[[], None]) -> Callable[[], None]:
        """Return the function that reads the state of joints and base after a step."""

        def read_state() -> None:
            read_joints()
            self._previous_spin = self._spin
            self._velocity, spin = self.world_body.base_velocity()
            self._spin = np.array(spin)

        return read_state

    def add_loads(
        self, loads: ExternalLoads, time: float, actuation: Array, law: SpringDamperLaw
    ) -> None:
        """Add what the joints feel of loads to the actuation of the law; keep the rest."""
        load = self._load = loads.force(time, law.angles)
        own = self.world_body.to_base_axes(load)
        joint_torques = self.world_body.equivalent_joint_torques(own)
        np.add(actuation, joint_torques, law.actuation)
        self._base_wrench, self._residual_torques = own[:6], own[6:] - joint_torques

    def load_power(self, rates: Array) -> float:
        """Return the power of the loads on base and joints in the last step."""
        power: float = self._load.dot([*self._spin, *self._velocity, *rates])
        return power

    def mark_start(self) -> None:
        """Let the spin half a step on from here be that of the start."""
        self._previous_spin = 3 * self._spin - 2 * np.array(self.body.start.angular_velocity)
        self._spin_change = self._spin - self._previous_spin

    def velocity_half_step_before(
        self, law: SpringDamperLaw, before: BaseVelocity, after: BaseVelocity, rates_after: Array
    ) -> BaseVelocity:
        """Return the velocity half a step before a start; see `FixedBase`."""
        axes = np.array(self.world_body.base_inertial_pose().rotation)
        if not self._spinning.is_needed(before[1] @ axes, np.array(self.body.start.rates)):
            return super().velocity_half_step_before(law, before, after, rates_after)
        start, then = (
            np.concatenate([spin @ axes, linear @ axes, rates])
            for (linear, spin), rates in ((before, self.body.start.rates), (after, rates_after))
        )
        motion = self._spinning.motion_half_step_before(law.angles, start, then, law.rates)
        return geometry.vector(axes @ motion[3:6]), geometry.vector(axes @ motion[:3])

    def rate(self) -> float:
        """Return the angular velocity [rad/s]."""
        return float(np.linalg.norm(self._spin))

    def needs_fresh_inertia(self) -> bool:
        """Return whether the body spins so fast that its momentum is followed."""
        return self._spinning.is_active

    def can_reuse_correction(self) -> bool:
        """Return False: the correction of the base is refreshed in every step."""
        return False

    def update_energy(
        self, energy: BodyEnergy, law: SpringDamperLaw, dynamics: Callable[[], ChainDynamics]
    ) -> None:
        """Add the base: its measured energy where it can touch something, else how far it fell."""
        base = self.world_body.base_pose()
        if not law.detects_impacts:
            moved = geometry.subtract(base.position, self.body.start.position)
            energy.bound_base_fall(geometry.norm(moved))
            return
        pose = dynamics().at(law.angles, base)
        velocity, spin = self.world_body.base_velocity()
        kinetic = pose.kinetic_energy([*spin, *velocity, *law.rates])
        energy.set_whole_energy(kinetic, pose.gravity_energy(self._gravity))

    def predict(self, law: SpringDamperLaw) -> None:
        """Have the law predict the coming step, with what the joints feel of the base's forces."""
        if self._is_spinning(law):
            self._predict_spinning(law)
            return
        world, angles = self.world_body, law.angles.tolist()
        coming_spin = self._coming_spin(law)
        centre = world.base_inertial_pose()
        present = world.bias(angles, law.rates.tolist(), self._spin.tolist(), centre)
        change: Array = np.empty(len(present))

        def joint_bias_at(rates: Array) -> Array:
            coming = world.bias(angles, rates.tolist(), coming_spin, centre)
            np.subtract(present, coming, change)
            return world.equivalent_joint_torques(coming)

        law.predict(world.equivalent_joint_torques(present), joint_bias_at)
        self._predicted = change, centre

    def _is_spinning(self, law: SpringDamperLaw) -> bool:
        """Whether the momentum is followed in the coming step; slow bodies are asked seldom."""
        self._steps += 1
        if not self._spinning.is_active and self._steps % MONITORING_INTERVAL:
            return False
        axes = np.array(self.world_body.base_inertial_pose().rotation)
        return self._spinning.is_needed(self._spin @ axes, law.rates)

    def _predict_spinning(self, law: SpringDamperLaw) -> None:
        centre = self.world_body.base_inertial_pose()
        axes = np.array(centre.rotation)
        motion = np.concatenate([self._spin @ axes, self._velocity @ axes, law.rates])
        coming_spin = self._coming_spin(law) @ axes
        change = self._spinning.predict(law, axes, motion, self._base_wrench, coming_spin)
        self._predicted = change, centre

    def finish(self, law: SpringDamperLaw, change: Array | None) -> None:
        """Apply the torques of the predicted step, and the wrench of the base."""
        world = self.world_body
        correction, centre = self._predicted
        torques = law.settle(change)
        # the law knows what the joints feel of the correction
        residual_torques = correction[6:] - law.correction
        wrench = correction[:6]
        if self.counts_load_power:
            wrench += self._base_wrench
            residual_torques += self._residual_torques
        world.apply_base_wrench(wrench, centre)
        world.apply((residual_torques + torques).tolist())

    def _coming_spin(self, law: SpringDamperLaw) -> list[float]:
        """Return the angular velocity at the instant of the angles, without that of impacts."""
        change = self._spin - self._previous_spin
        if law.detects_impacts:
            change, self._spin_change = (
                limited_change(change, self._spin_change, SMOOTH / law.time_step),
                change,
            )
        coming: list[float] = (self._spin + 0.5 * change).tolist()
        return coming

    def _apply_with_loads(self, torques: Sequence[float]) -> None:
        if self.counts_load_power:
            self.world_body.apply_base_wrench(self._base_wrench)
            torques = (self._residual_torques + torques).tolist()
        self.world_body.apply(torques)
