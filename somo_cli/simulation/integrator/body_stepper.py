"""Steps one body: applies the torques of its law, reads its state, counts its energy."""

from __future__ import annotations

import itertools
import math
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
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
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.joint_limits import JointLimits
from somo_cli.simulation.integrator.refresh_policy import (
    MONITORING_INTERVAL,
    REUSE_STEPS,
    SLOW_REFRESH,
    RefreshPolicy,
)
from somo_cli.simulation.plan.joint_springs import JointSprings
from somo_cli.simulation.plan.model import Body, Plan

NEAR_LIMIT = 0.1  # rad: with a joint nearer to its limit no correction is reused
FAR_LIMIT = 1.0  # rad: a joint farther from its limits does not reach them before the next check,
LOOKAHEAD = 2.0  # nor one that would not in so many times the time until then
FAR_RATIO = 4.0  # D + N and B are refreshed after this many times the joint motion of M


class BodyStepper:
    """One body in motion; most steps are an `apply_torques` and a `read_state`."""

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        joints = body.chain.joints
        springs = JointSprings(
            np.array([joint.stiffness for joint in joints]),
            np.array([joint.damping for joint in joints]),
            np.array([joint.neutral_position for joint in joints]),
        )
        self.body = body
        self.world_body = world_body
        self.law = SpringDamperLaw(springs, plan.time_step, plan.integrator)
        self.law.detects_impacts = plan.can_touch
        self.loads = ExternalLoads(body, world_body.base_pose) if body.loads else None
        self.actuation: Array = np.zeros(len(joints)) if body.loads else self.law.actuation
        """Torques of the actuation alone; the law counts loads as actuation as well."""
        self._limits = JointLimits(joints)
        self.energy = BodyEnergy(body, springs, plan.gravity)
        self.mass: Array = np.zeros((0, 0))
        self.mass_at_start: Array = self.mass
        self.max_rate = 0.0  # rad/s
        self._mass_angles: Array = np.zeros(0)
        self._moved_since = (
            0.0  # rad, since M was refreshed: root of the sum of squares over the joints
        )
        self._clearance_at_refresh = math.nan  # rad, to the nearest limit; NaN until it is needed
        self._coefficient_angles: Array = np.full(len(joints), math.inf)
        self._apply_reused = self._make_apply_reused()
        is_explicit = plan.integrator == "explicit"
        self.apply_torques: Callable[[], None] = (
            self._apply_reused if is_explicit else self._apply_refreshed
        )
        """Applies the torques of the law to the world."""
        self._working_torques: Array = self.law.actuation  # whose work on the joints is counted
        self._angles_at_work: Array = np.array(body.start.angles)  # when that was done last
        self._step_powers = 0.0  # summed over the steps since then
        self._rates = self.law.rates
        self._gravity = plan.gravity
        self._refresh_policy = RefreshPolicy(plan.time_step, plan.can_touch)
        self._at_check: tuple[Array, Array] | None = None  # correction and bias at the last check
        self._last_correction = np.zeros(0), np.zeros(0)  # correction and bias of the last refresh
        self._steps_reused = self._steps_left = 1
        self._waits = False  # whether torques that are worked out wait for `finish`
        self._apply_variants = {1: self._apply_refreshed, MONITORING_INTERVAL: self._apply_reused}
        self._apply_variants |= {steps: self._apply_alternating for steps in REUSE_STEPS[1:]}
        self._limit_torques = partial(
            self._limits.torques, plan.time_step, self.law.angles, self.law.rates
        )
        self._drives = [
            (drive.signal.at, _setter(self.actuation, drive.joints)) for drive in body.drives
        ]
        self._given_torques: dict[tuple[int, ...], _GivenTorque] = {}
        self._actuation_time = 0.0  # s, of the actuation
        self._dynamics: ChainDynamics | None = None
        self.read_state = self._make_read_state()

    def dynamics(self) -> ChainDynamics:
        """Return the body's chain as arrays; made when first asked for."""
        if self._dynamics is None:
            self._dynamics = ChainDynamics(self.body.chain)
        return self._dynamics

    def actuate(self, time: float) -> None:
        """Set the actuation torques of a time [s], and the loads at the present pose."""
        self._actuation_time = time
        for at, put in self._drives:
            put(at(time))
        for given in self._given_torques.values():
            given.put(given.torque)
        if self.loads is not None:
            self._apply_load(self.loads.force(time, self.law.angles))

    def _apply_load(self, load: Array) -> None:
        """Add the generalised force of the loads, shape (6 + n,), to the actuation of the law."""
        np.add(self.actuation, load[6:], self.law.actuation)

    def give_torque(self, joints: tuple[int, ...], torque: float, factor: float) -> None:
        """Apply a torque [N·m] to joints from the next `actuate` on.

        It replaces what the scene says, until another torque is given. `factor` leads to engine
        units.
        """
        put = _setter(self.actuation, joints)
        self._given_torques[joints] = _GivenTorque(put, factor * torque, torque)

    def si_actuation(self) -> Array:
        """Return the actuation torque of each joint in the present step [N·m], shape (n,)."""
        torques: Array = np.zeros(len(self.law.rates))
        for drive in self.body.drives:
            torques[list(drive.joints)] = drive.si_signal.at(self._actuation_time)
        for joints, given in self._given_torques.items():
            torques[list(joints)] = given.si_torque
        return torques

    def rates_of_instant(self) -> Array:
        """Return the joint rates at the instant of the angles [rad/s], shape (n,).

        The implicit integrator has them half a step earlier; they are extrapolated with the
        acceleration of the last step, to second order.
        """
        return self.law.rates_of_instant()

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which `actuate` changes nothing after `time`."""
        until = math.inf if self.loads is None else self.loads.constant_until(time)
        for drive in self.body.drives:
            if until <= time:  # no other can be steady for less
                return until
            until = min(until, drive.signal.constant_until(time))
        return until

    def apply(self, torques: Sequence[float]) -> None:
        """Apply torques of the law to the engine, and what of the loads the law leaves out."""
        self.world_body.apply(torques)

    @property
    def rates(self) -> Array:
        """Joint rates as the engine has them, shape (n,)."""
        return self.law.rates

    def apply_at_check(self) -> None:
        """Apply the torques of the law at a check, and choose how to step until the next one.

        The correction for the engine's early Coriolis forces costs two calls into the engine. While
        the body moves slowly, and the correction changed so little since the last check that
        reusing it costs less than the error of the method, it is not refreshed in every step.
        """
        law = self.law
        if self._refresh_policy.is_gravity_implicit:
            # at checks, not with M: any such part of B is as accurate as a fresh one
            law.coefficients.set_gravity_stiffness(
                positive_gravity_stiffness(self._pose(), self._gravity), self.mass
            )
        self.refresh_if_moved()
        if law.integrator == "explicit":
            self.apply_torques()
            return
        reach = FAR_LIMIT + LOOKAHEAD * MONITORING_INTERVAL * law.time_step * self.max_rate
        clearance = self._clearance(reach)
        law.limit_torques = self._limit_torques if clearance < reach else None
        self._apply_corrected()
        assert law.bias is not None
        last = self._at_check
        self._at_check = self._last_correction = law.correction, law.bias
        steps = 1
        if last is not None and clearance > NEAR_LIMIT:
            growth = law.correction - last[0]
            steps = self._reuse_steps(growth)
            if steps > 1:
                law.reuse(last[1] - law.bias, growth, MONITORING_INTERVAL)
        self._steps_reused = self._steps_left = steps
        self.apply_torques = self._apply_variants[steps]
        self._refresh_policy.set_reuse(steps)

    def _reuse_steps(self, change: Array) -> int:
        """Return for how many steps a correction that changed by `change` may be reused."""
        return self._refresh_policy.reuse_steps(change / self.mass.diagonal(), self.max_rate)

    def _clearance(self, enough: float) -> float:
        """Return the least distance of a joint from its limit [rad], exact only below `enough`."""
        if math.isnan(self._clearance_at_refresh):
            self._clearance_at_refresh = self._limits.clearance(self._mass_angles)
        # no joint has moved farther than the root of the sum of squares
        clearance = self._clearance_at_refresh - self._moved_since
        return clearance if clearance >= enough else self._limits.clearance(self.law.angles)

    def _make_apply_reused(self) -> Callable[[], None]:
        """Return the function that applies torques with a reused correction."""
        return self.law.make_reuse(self.world_body.apply)

    def _apply_alternating(self) -> None:
        """Reuse the correction, and refresh it in every second or fourth step."""
        self._steps_left -= 1
        if self._steps_left:
            if self._waits:
                self.law.predict_held()
            else:
                self._apply_reused()
            return
        self.refresh_if_moved()
        law, (correction, bias), steps = self.law, self._last_correction, self._steps_reused
        self._apply_corrected()
        assert law.bias is not None
        law.reuse(bias - law.bias, law.correction - correction, steps)
        self._last_correction, self._steps_left = (law.correction, law.bias), steps

    def _apply_refreshed(self) -> None:
        self.refresh_if_moved()
        self._apply_corrected()

    def _apply_corrected(self) -> None:
        self._predict_corrected()
        if not self._waits:
            self._finish_corrected()

    def _predict_corrected(self) -> None:
        angles, world = self.law.angles.tolist(), self.world_body
        present = world.bias(angles, self.law.rates.tolist())
        self.law.predict(present, lambda rates: world.bias(angles, rates.tolist()))

    def _finish_corrected(self, change: Array | None = None) -> None:
        self.world_body.apply(self.law.settle(change))

    def predict(self, is_check: bool) -> None:
        """Compute torques as `apply_at_check` or `apply_torques` do, to be applied by `finish`."""
        self._waits = True
        if is_check:
            self.apply_at_check()
        elif self.apply_torques == self._apply_reused:
            self.law.predict_held()
        else:
            self.apply_torques()
        self._waits = False

    def finish(self, change: Array | None) -> None:
        """Apply the torques, with what changes of contact forces add to the acceleration."""
        self._finish_corrected(change)

    def _make_read_state(self) -> Callable[[], None]:
        """Return the function that reads angles and rates from the engine, with bound names."""
        joint_states, motion = self.world_body.joint_states, self.law.motion.data
        pack = struct.Struct(f"{2 * len(self.law.rates)}d").pack_into

        angle, rate = itemgetter(0), itemgetter(1)

        def read_state() -> None:
            states = joint_states()
            pack(motion, 0, *map(angle, states), *map(rate, states))

        return read_state

    def measure(self) -> None:
        """Measure speed and energy of the present state, for the divergence monitor."""
        rates = self.law.rates.tolist()
        # NaN must win, which max() alone would not let it
        self.max_rate = max(max(rates), -min(rates)) if math.isfinite(sum(rates)) else math.nan
        if math.isnan(self.max_rate):
            return  # the divergence monitor ends the run
        self._update_energy()

    def _update_energy(self) -> None:
        """Update the energy of the present state."""
        self.energy.update(self.law.angles, self.law.rates, self.mass)

    def gravity_work(self) -> float:
        """Return what gravity has given the body since its start; engine units, and slow."""
        base = self.world_body.base_pose()
        now = self.dynamics().at(self.law.angles, base).gravity_energy(self._gravity)
        start = self.body.start
        return (
            self.dynamics().at(np.array(start.angles), start.pose).gravity_energy(self._gravity)
            - now
        )

    def count_step_work(self) -> None:
        """Count the work of the last step, in which the joints moved by their rates."""
        self._step_powers += self._working_torques.dot(self._rates)

    def count_work(self, is_steady: bool) -> None:
        """Add the work done since the last call to the energy bound.

        It was counted step by step, unless the torques were constant (`is_steady`).
        """
        angles = self.law.angles
        if is_steady:
            work = self._working_torques.dot(angles - self._angles_at_work)
        else:
            work = self.law.time_step * self._step_powers
            self._step_powers = 0.0
        self.energy.add_work(float(work))
        self._angles_at_work[:] = angles

    def refresh_if_moved(self) -> None:
        """Refresh the mass matrix if the joints have moved too far since the last time."""
        moved = self.law.angles - self._mass_angles
        self._moved_since = math.sqrt(moved.dot(moved))
        if self._moved_since > self._refresh_policy.refresh_angle:
            self.refresh()

    def refresh(self) -> None:
        """Refresh the mass matrix for the present angles."""
        angles = self._mass_angles = self.law.angles.copy()
        self._moved_since, self._clearance_at_refresh = 0.0, math.nan
        self.mass = self.world_body.mass_matrix(angles.tolist())
        moved = angles - self._coefficient_angles
        refreshes_implicit = (
            moved.dot(moved) > (FAR_RATIO * self._refresh_policy.refresh_angle) ** 2
        )
        if refreshes_implicit:
            self._coefficient_angles = angles
        self.law.refresh(self.mass, refreshes_implicit)

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
            self.law.coefficients.set_gravity_stiffness(
                positive_gravity_stiffness(self._pose(), self._gravity), self.mass
            )
            self.refresh()

    def set_start_force(self, force: Array, rates: Array) -> None:
        """Set the force on the joints that was measured at the start, at these rates."""
        spin = self.body.start.angular_velocity
        bias = self.world_body.bias(self.law.angles.tolist(), rates.tolist(), spin)
        self.law.set_force(force, self.world_body.equivalent_joint_torques(bias))

    def _pose(self) -> ChainPose:
        """Return the chain at the present angles, its base at the start pose."""
        return self.dynamics().at(self.law.angles, self.body.start.pose)

    def reset_to_start(
        self,
        rates: Sequence[float] | None = None,
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        """Reset the body to its start, with other velocities if given."""
        start = self.body.start
        self.world_body.reset(start.angles, rates or start.rates, base_velocity)
        self.read_state()


@dataclass(frozen=True, slots=True)
class _GivenTorque:
    """A torque from outside [engine units and N·m], and the function that sets it on its joints."""

    put: Callable[[float], None]
    torque: float
    si_torque: float


def _setter(values: Array, joints: tuple[int, ...]) -> Callable[[float], None]:
    """Return the function that gives some of the values, those of these joints, one number."""
    steps = {after - before for before, after in itertools.pairwise(joints)}
    if len(steps) > 1:
        return partial(values.__setitem__, np.array(joints))
    # evenly spaced ones are a view, which is filled in half of the time
    view: Array = values[joints[0] : joints[-1] + 1 : steps.pop() if steps else 1]
    return view.fill
