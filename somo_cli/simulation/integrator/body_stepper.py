"""Steps one body: applies the torques of its law, reads its state, counts its energy."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from operator import itemgetter

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.dynamics.external_loads import ExternalLoads
from somo_cli.simulation.dynamics.linearization import (
    fastest_gravity_mode,
    largest_inertia_change,
    positive_gravity_stiffness,
)
from somo_cli.simulation.dynamics.modal import natural_frequencies
from somo_cli.simulation.engine.interface import WorldBody
from somo_cli.simulation.integrator.body_actuation import BodyActuation
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.integrator.fixed_base import FixedBase
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.joint_inertia import JointInertia
from somo_cli.simulation.integrator.joint_limits import JointLimits
from somo_cli.simulation.integrator.joint_work import JointWork
from somo_cli.simulation.integrator.law_stepper import LawStepper
from somo_cli.simulation.integrator.refresh_policy import SLOW_REFRESH, RefreshPolicy
from somo_cli.simulation.plan.joint_springs import JointSprings
from somo_cli.simulation.plan.model import Body, Plan


class BodyStepper:
    """One body in motion; most steps are an `apply_torques` and a `read_state`.

    `base` knows how the base moves; without one it is fixed.
    """

    def __init__(
        self, plan: Plan, body: Body, world_body: WorldBody, base: FixedBase | None = None
    ) -> None:
        joints = body.chain.joints
        springs = JointSprings(
            np.array([joint.stiffness for joint in joints]),
            np.array([joint.damping for joint in joints]),
            np.array([joint.neutral_position for joint in joints]),
        )
        self.body = body
        self.world_body = world_body
        self.base = base or FixedBase(body, world_body)
        self.law = SpringDamperLaw(springs, plan.time_step, plan.integrator)
        self.law.detects_impacts = plan.can_touch
        loads = ExternalLoads(body, world_body.base_pose) if body.loads else None
        # the law counts loads as actuation as well
        torques: Array = np.zeros(len(joints)) if body.loads else self.law.actuation
        self.actuation = BodyActuation(body, torques, loads)
        self.energy = BodyEnergy(body, springs, plan.gravity)
        self.work = JointWork(self.law, torques, self.base, self.energy)
        self.limits = JointLimits(joints)
        self._refresh_policy = RefreshPolicy(plan.time_step, plan.can_touch)
        self.inertia = JointInertia(world_body, self.law, self.limits, self._refresh_policy)
        self.mass_at_start: Array = self.inertia.matrix
        self.max_rate = 0.0  # rad/s
        self.law_stepper = LawStepper(
            self.law, self.base, self.inertia, self.limits, self._refresh_policy
        )
        self._gravity = plan.gravity
        self._dynamics: ChainDynamics | None = None
        self.read_state = self._make_read_state()
        """Reads the state of the body from the engine."""
        if self.base.start_velocity is not None:
            self.reset_to_start()

    def dynamics(self) -> ChainDynamics:
        """Return the body's chain as arrays; made when first asked for."""
        if self._dynamics is None:
            self._dynamics = ChainDynamics(self.body.chain)
        return self._dynamics

    def actuate(self, time: float) -> None:
        """Set what acts in the step that starts at a time [s]; loads at the present pose."""
        actuation = self.actuation
        actuation.set_torques(time)
        if actuation.loads is not None:
            self.base.add_loads(actuation.loads, time, actuation.torques, self.law)
        self.base.actuate(time)

    def rates_of_instant(self) -> Array:
        """Return the joint rates at the instant of the angles [rad/s], shape (n,).

        The implicit integrator has them half a step earlier; they are extrapolated with the
        acceleration of the last step, to second order.
        """
        return self.law.rates_of_instant()

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which `actuate` changes nothing after `time`."""
        until = self.base.constant_until(time)
        return until if until <= time else min(until, self.actuation.constant_until(time))

    @property
    def rates(self) -> Array:
        """Joint rates as the engine has them, shape (n,)."""
        return self.law.rates

    @property
    def apply_torques(self) -> Callable[[], None]:
        """Applies the torques of the law to the world; chosen anew at each check."""
        return self.law_stepper.apply_torques

    @property
    def base_rate(self) -> float:
        """The angular velocity of the base [rad/s] if nothing holds that, else 0."""
        return self.base.rate()

    def apply_at_check(self) -> None:
        """Apply the torques of the law at a check, and choose how to step until the next one."""
        if self._refresh_policy.is_gravity_implicit:
            self._refresh_gravity_stiffness()
        self.law_stepper.apply_at_check(self.max_rate)

    def predict(self, is_check: bool) -> None:
        """Compute torques as `apply_at_check` or `apply_torques` do, to be applied by `finish`."""
        if not is_check:
            self.law_stepper.predict()
            return
        if self._refresh_policy.is_gravity_implicit:
            self._refresh_gravity_stiffness()
        self.law_stepper.predict_at_check(self.max_rate)

    def finish(self, change: Array | None) -> None:
        """Apply the torques, with what changes of contact forces add to the acceleration."""
        self.base.finish(self.law, change)

    def _make_read_state(self) -> Callable[[], None]:
        """Return the function that reads the state from the engine, its names bound."""
        joint_states, motion = self.world_body.joint_states, self.law.motion.data
        pack = struct.Struct(f"{2 * len(self.law.rates)}d").pack_into

        angle, rate = itemgetter(0), itemgetter(1)

        def read_state() -> None:
            states = joint_states()
            pack(motion, 0, *map(angle, states), *map(rate, states))

        return self.base.reader(read_state)

    def measure(self) -> None:
        """Measure speed and energy of the present state, for the divergence monitor."""
        rates = self.law.rates.tolist()
        # NaN must win, which max() alone would not let it
        self.max_rate = max(max(rates), -min(rates)) if math.isfinite(sum(rates)) else math.nan
        if math.isnan(self.max_rate):
            return  # the divergence monitor ends the run
        self.energy.update(self.law.angles, self.law.rates, self.mass)
        self.base.update_energy(self.energy, self.law, self.dynamics)

    def gravity_work(self) -> float:
        """Return the work of gravity on the body since its start; engine units, and slow.

        Zero where the energy of the body counts it.
        """
        if self.base.energy_includes_base:
            return 0.0
        base = self.world_body.base_pose()
        now = self.dynamics().at(self.law.angles, base).gravity_energy(self._gravity)
        start = self.body.start
        return (
            self.dynamics().at(np.array(start.angles), start.pose).gravity_energy(self._gravity)
            - now
        )

    @property
    def mass(self) -> Array:
        """The joint-space inertia, shape (n, n); a new array each time it is refreshed."""
        return self.inertia.matrix

    def linearize(self) -> None:
        """Linearize at the start: its modes set the refresh policy."""
        slowest = float(natural_frequencies(self.mass, self.law.springs.stiffness)[0])
        # gravity moves a free body as a whole, and no joint
        is_free = self.body.base == "free"
        gravity_mode = (
            0.0 if is_free else fastest_gravity_mode(self._pose(), self._gravity, self.mass)
        )
        inertia_change = largest_inertia_change(
            self.dynamics(), self.law.angles, is_free, SLOW_REFRESH
        )
        self._refresh_policy.set_modes(slowest, gravity_mode, inertia_change)
        if self._refresh_policy.is_gravity_implicit:
            self._refresh_gravity_stiffness()
            self.inertia.refresh()

    def _refresh_gravity_stiffness(self) -> None:
        # at checks, not with M: any such part of B is as accurate as a fresh one
        self.law.coefficients.set_gravity_stiffness(
            positive_gravity_stiffness(self._pose(), self._gravity), self.mass
        )

    def set_start_force(self, force: Array, rates: Array) -> None:
        """Set the force on the joints that was measured at the start, at these rates."""
        self.law.set_force(force, self.base.start_bias(self.law, rates))
        self.base.mark_start()

    def _pose(self) -> ChainPose:
        """Return the chain at the present angles, for linearization."""
        return self.dynamics().at(self.law.angles, self.base.pose())

    def reset_to_start(
        self,
        rates: Sequence[float] | None = None,
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        """Reset the body to its start, with other velocities if given."""
        start = self.body.start
        velocity = self.base.start_velocity or base_velocity
        self.world_body.reset(start.angles, rates or start.rates, velocity)
        self.read_state()
