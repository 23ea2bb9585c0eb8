"""One body in motion: its law, what acts on it and its energy."""

from __future__ import annotations

import itertools
import math
import struct
from collections.abc import Callable, Sequence
from functools import partial
from operator import itemgetter

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.dynamics.external_loads import BodyLoads
from somo_cli.simulation.dynamics.linearization import fastest_fall, pendulum, staleness
from somo_cli.simulation.dynamics.modal import natural_frequencies
from somo_cli.simulation.engine.interface import WorldBody
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.integrator.implicit_law import SpringLaw
from somo_cli.simulation.integrator.joint_limits import Stops
from somo_cli.simulation.integrator.refresh_policy import (
    CALM_REFRESH,
    HOLDS,
    STEPS_BETWEEN_LOOKS,
    Pace,
)
from somo_cli.simulation.plan.joint_springs import Springs
from somo_cli.simulation.plan.model import Body, Plan

CALM_ROOM = 0.1  # rad: a body with a joint nearer to its limit is not calm
SWIFT_ROOM = 1.0  # rad: joints farther from their limits do not reach them before the next look,
SWIFT_BLOCKS = 2.0  # nor those that would not do so in so many times the time until then
FAR = 4.0  # times as far as that until what is implicit in the law is renewed as well


class Runner:
    """One body in motion; most steps are a `push` and a `pull`."""

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        joints = body.chain.joints
        springs = Springs(
            np.array([joint.stiffness for joint in joints]),
            np.array([joint.damping for joint in joints]),
            np.array([joint.neutral_position for joint in joints]),
        )
        self.body = body
        self.world_body = world_body
        self.law = SpringLaw(springs, plan.time_step, plan.integrator)
        self.law.can_be_struck = plan.can_touch
        self.loads = BodyLoads(body, world_body.base_pose) if body.loads else None
        self.actuation: Array = np.zeros(len(joints)) if body.loads else self.law.actuation
        """Torques of the actuation alone; to the law, loads are actuation too."""
        self._stops = Stops(joints)
        self.energy = BodyEnergy(body, springs, plan.gravity)
        self.mass: Array = np.zeros((0, 0))
        self.mass_at_start: Array = self.mass
        self.fastest = 0.0  # rad/s
        self._mass_angles: Array = np.zeros(0)
        self._moved_since = 0.0  # rad since then, as the root of the sum of squares over the joints
        self._room_then = math.nan  # rad; to the nearest limit, once somebody has asked
        self._parts_angles: Array = np.full(len(joints), math.inf)
        self._push_held = self._make_push_held()
        is_explicit = plan.integrator == "explicit"
        self.push: Callable[[], None] = self._push_held if is_explicit else self._push_swiftly
        """Applies the torques of the law to the world."""
        self._acting: Array = self.law.actuation  # whose work on the joints is counted
        self._worked_at: Array = np.array(body.start.angles)  # when that was done last
        self._power = 0.0  # summed over the steps since then
        self._rates = self.law.rates
        self._gravity = plan.gravity
        self._pace = Pace(plan.time_step, plan.can_touch)
        self._looked_at: tuple[Array, Array] | None = None  # correction and bias at the last look
        self._corrected = np.zeros(0), np.zeros(0)  # and when they were renewed last
        self._held_steps = self._steps_left = 1
        self._pushes = {1: self._push_swiftly, STEPS_BETWEEN_LOOKS: self._push_held}
        self._pushes |= {steps: self._push_in_turns for steps in HOLDS[1:]}
        self._stop = partial(self._stops.torques, plan.time_step, self.law.angles, self.law.rates)
        self._drives = [
            (drive.signal.at, _setter(self.actuation, drive.joints)) for drive in body.drives
        ]
        self._given_torques: dict[tuple[int, ...], tuple[Callable[[float], None], float]] = {}
        self._dynamics: ChainDynamics | None = None
        self.pull = self._make_pull()

    def dynamics(self) -> ChainDynamics:
        """Return the body's chain as arrays; made when first asked for."""
        if self._dynamics is None:
            self._dynamics = ChainDynamics(self.body.chain)
        return self._dynamics

    def actuate(self, time: float) -> None:
        """Set the actuation torques of a time [s], and the loads at the present pose."""
        for at, put in self._drives:
            put(at(time))
        for put, torque in self._given_torques.values():
            put(torque)
        if self.loads is not None:
            self._carry(self.loads.force(time, self.law.angles))

    def _carry(self, load: Array) -> None:
        """Tell the law of a generalised force of loads, shape (6 + n,)."""
        np.add(self.actuation, load[6:], self.law.actuation)

    def give_torque(self, joints: tuple[int, ...], torque: float) -> None:
        """Have a torque [engine units] act on joints, in place of what the scene says, until told.

        It acts from the next `actuate` on.
        """
        self._given_torques[joints] = _setter(self.actuation, joints), torque

    def rates_of_instant(self) -> Array:
        """Return the joint rates at the instant of the angles [rad/s], shape (n,).

        The implicit law has them half a step earlier; they are carried on with the acceleration of
        the last step, to second order.
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
        """Apply torques of the law to the world, and what it takes for the loads to be whole."""
        self.world_body.apply(torques)

    @property
    def rates(self) -> Array:
        """Joint rates as the engine has them, shape (n,)."""
        return self.law.rates

    def push_first(self) -> None:
        """Apply the torques of the law at a look, and decide how to go on until the next.

        The correction for the engine's early Coriolis forces costs two calls into the engine. It
        need not be renewed in every step while the body moves slowly and the correction changed
        so little since the last look that holding it cost less than the method's own error.
        """
        law = self.law
        if self._pace.is_heavy:
            # with looks, not with the mass: any such part of B is as good as a fresh one
            law.parts.take_pendulum(pendulum(self._pose(), self._gravity), self.mass)
        self.refresh_if_moved()
        if law.integrator == "explicit":
            self.push()
            return
        reach = SWIFT_ROOM + SWIFT_BLOCKS * STEPS_BETWEEN_LOOKS * law.time_step * self.fastest
        room = self._room(reach)
        law.stop = self._stop if room < reach else None
        self._push_corrected()
        assert law.bias is not None
        last = self._looked_at
        self._looked_at = self._corrected = law.correction, law.bias
        held = 1
        if last is not None and room > CALM_ROOM:
            growth = law.correction - last[0]
            held = self._steps_to_hold(growth)
            if held > 1:
                law.hold(last[1] - law.bias, growth, STEPS_BETWEEN_LOOKS)
        self._held_steps = self._steps_left = held
        self.push = self._pushes[held]
        self._pace.go_on(held)

    def _steps_to_hold(self, change: Array) -> int:
        """Return for how many steps a correction may be held that changed so between two looks."""
        return self._pace.steps_to_hold(change / self.mass.diagonal(), self.fastest)

    def _room(self, enough: float) -> float:
        """Return how far the joint nearest to a limit is from it [rad], or what is `enough`."""
        if math.isnan(self._room_then):
            self._room_then = self._stops.room(self._mass_angles)
        # no joint has moved farther than all together
        room = self._room_then - self._moved_since
        return room if room >= enough else self._stops.room(self.law.angles)

    def _make_push_held(self) -> Callable[[], None]:
        """Return the function that applies torques with the correction held."""
        return self.law.make_hold(self.world_body.apply)

    def _push_in_turns(self) -> None:
        """Hold the correction, but for every second or fourth step, which renews it."""
        self._steps_left -= 1
        if self._steps_left:
            self._push_held()
            return
        self.refresh_if_moved()
        law, (correction, bias), steps = self.law, self._corrected, self._held_steps
        self._push_corrected()
        assert law.bias is not None
        law.hold(bias - law.bias, law.correction - correction, steps)
        self._corrected, self._steps_left = (law.correction, law.bias), steps

    def _push_swiftly(self) -> None:
        self.refresh_if_moved()
        self._push_corrected()

    def _push_corrected(self) -> None:
        angles, world = self.law.angles.tolist(), self.world_body
        present = world.bias(angles, self.law.rates.tolist())
        torques = self.law.correct(present, lambda rates: world.bias(angles, rates.tolist()))
        world.apply(torques)

    def _make_pull(self) -> Callable[[], None]:
        """Return the function that reads angles and rates from the world, its names bound."""
        joint_states, motion = self.world_body.joint_states, self.law.motion.data
        pack = struct.Struct(f"{2 * len(self.law.rates)}d").pack_into

        angle, rate = itemgetter(0), itemgetter(1)

        def pull() -> None:
            states = joint_states()
            pack(motion, 0, *map(angle, states), *map(rate, states))

        return pull

    def measure(self) -> None:
        """Take the speed and the energy of the present state, for the watch."""
        rates = self.law.rates.tolist()
        # a rate that is not a number must win, which max() alone would not let it
        self.fastest = max(max(rates), -min(rates)) if math.isfinite(sum(rates)) else math.nan
        if math.isnan(self.fastest):
            return  # the watch stops the run; there is no energy to tell
        self._account()

    def _account(self) -> None:
        """Take the energy of the present state."""
        self.energy.update(self.law.angles, self.law.rates, self.mass)

    def count_step(self) -> None:
        """Count the work of the last step, over which the joints moved by their rates."""
        self._power += self._acting.dot(self._rates)

    def count_work(self, is_steady: bool) -> None:
        """Tell the energy of work done since the last call.

        It was counted step by step, unless what acted is steady.
        """
        angles = self.law.angles
        if is_steady:
            work = self._acting.dot(angles - self._worked_at)
        else:
            work = self.law.time_step * self._power
            self._power = 0.0
        self.energy.give(float(work))
        self._worked_at[:] = angles

    def refresh_if_moved(self) -> None:
        """Renew the mass matrix if it is that of angles too far from the present ones."""
        moved = self.law.angles - self._mass_angles
        self._moved_since = math.sqrt(moved.dot(moved))
        if self._moved_since > self._pace.refresh_angle:
            self.refresh()

    def refresh(self) -> None:
        """Renew the mass matrix for the present angles."""
        angles = self._mass_angles = self.law.angles.copy()
        self._moved_since, self._room_then = 0.0, math.nan
        self.mass = self.world_body.mass_matrix(angles.tolist())
        moved = angles - self._parts_angles
        is_far = moved.dot(moved) > (FAR * self._pace.refresh_angle) ** 2
        if is_far:
            self._parts_angles = angles
        self.law.refresh(self.mass, is_far)

    def assess(self) -> None:
        """Ask, at the start, for what decides how the body is to be followed."""
        slowest = float(natural_frequencies(self.mass, self.law.springs.stiffness)[0])
        # gravity moves a free body as a whole, and no joint
        is_free = self.body.base == "free"
        fall = 0.0 if is_free else fastest_fall(self._pose(), self._gravity, self.mass)
        change = staleness(self.dynamics(), self.law.angles, is_free, CALM_REFRESH)
        self._pace.assess(slowest, fall, change)
        if self._pace.is_heavy:
            self.law.parts.take_pendulum(pendulum(self._pose(), self._gravity), self.mass)
            self.refresh()

    def begin(self, force: Array, rates: Array) -> None:
        """Take the force on the joints that was measured at the start, at these rates."""
        spin = self.body.start.angular_velocity
        bias = self.world_body.bias(self.law.angles.tolist(), rates.tolist(), spin)
        self.law.measure(force, self.world_body.felt_by_joints(bias))

    def _pose(self) -> ChainPose:
        """Return the chain as it is now, the base as it started, without asking the engine."""
        return self.dynamics().at(self.law.angles, self.body.start.pose)

    def go_to_start(
        self,
        rates: Sequence[float] | None = None,
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        """Put the body back to its start, with other velocities if given."""
        start = self.body.start
        self.world_body.reset(start.angles, rates or start.rates, base_velocity)
        self.pull()


def _setter(values: Array, joints: tuple[int, ...]) -> Callable[[float], None]:
    """Return the function that gives some of the values, those of these joints, one number."""
    steps = {after - before for before, after in itertools.pairwise(joints)}
    if len(steps) > 1:
        return partial(values.__setitem__, np.array(joints))
    # evenly spaced ones are a view, which is filled in half of the time
    view: Array = values[joints[0] : joints[-1] + 1 : steps.pop() if steps else 1]
    return view.fill
