"""A floating base that spins fast: its step keeps the momentum of the whole body.

Coriolis and gyroscopic forces at an extrapolated velocity are of second order, yet they add energy
to a body that spins, the more the farther it turns in a step. Above a rate they are taken at the
mean of the velocities before and after the step, and the base moves so that the momentum of the
whole body stays what it was, but for what acted from outside (see `base_momentum`). Both depend on
the acceleration of the joints, which depends on them, so a few rounds find all three. Where these
do not converge, as with a light base that long chains throw about, extrapolation goes on.

What counts is the rate at which the body would turn if its joints stopped: a base may turn to and
fro, and the body not spin.

What acts from outside beside gravity and loads is contact. The engine tells it by the difference of
the velocity to that foreseen, and the coming step is expected to have the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.dynamics.base_momentum import Momentum, WholeInertia, turned_half_way
from somo_cli.simulation.engine.interface import WorldBody, WorldFreeBody
from somo_cli.simulation.integrator.fixed_point import fixed_point
from somo_cli.simulation.integrator.impacts import SMOOTH
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw

ENERGY_GROWTH = 1e-4  # 1/s: a bound on the relative growth of energy left to extrapolation; bodies
# of many shapes gained a third of it or less
LEAVE_RATIO = 0.8  # of the rate at which the momentum starts to be followed
_MAX_ROUNDS = 30  # 3 to 5 are enough for steps up to 0.1 rad
_TOLERANCE = 1e-10  # rad: what the joints may turn less in a step in another round


def spin_to_follow(time_step: float) -> float:
    """Return the angular velocity [rad/s] from which on the momentum is followed.

    An oscillation at a rate ω grows by (h ω)⁴ / 4 in a step if its force is extrapolated from the
    last two velocities, so its energy by (h ω)⁴ / (2 h) in a second.
    """
    rate: float = (2 * time_step * ENERGY_GROWTH) ** 0.25 / time_step
    return rate


@dataclass(frozen=True, slots=True)
class _LastStep:
    """The last step: the axes of the base before it, and the inertia and what was foreseen there.

    `motion`, shape (6 + n,), is the velocity after it without further contact, `contact` and
    `outside`, (6,), the impulse on the base that was foreseen, of contact and of contact and loads.
    All are in the base's axes.
    """

    axes: Array
    base_rows: Array  # of the inertia matrix, (6, 6 + n)
    motion: Array
    contact: Array
    outside: Array


class SpinningBase:
    """Follows the momentum of one body with a floating base; engine units."""

    def __init__(self, world_body: WorldBody, time_step: float, gravity: Vector) -> None:
        self._world = cast(WorldFreeBody, world_body)
        self._step = time_step
        self._gravity_step: Array = time_step * np.array(gravity)
        threshold = spin_to_follow(time_step)
        self._enter_squared, self._leave_squared = threshold**2, (LEAVE_RATIO * threshold) ** 2
        self._momentum = Momentum(np.zeros(3), np.zeros(3))  # in the world
        self._last: _LastStep | None = None

    def motion_half_step_before(
        self, angles: Array, start: Array, after: Array, rates: Array
    ) -> Array:
        """Return the velocities, (6 + n,), half a step before a start, with these joint rates.

        All are in the axes of the base at the start. A step of the engine from the velocities
        there, `start`, to those `after` it tells what acts from outside.
        """
        matrix = self._world.whole_mass_matrix(angles.tolist())
        bias = self._world.inertial_forces(angles.tolist(), start, np.zeros(len(start)))
        impulse = (matrix @ (after - start))[:6] + self._step * bias[:6]
        own = WholeInertia(matrix, start[6:]).momentum(start[:3], start[3:6])
        left = _with_impulse(own, -0.5 * impulse, matrix)
        return self._motion(left, angles, rates, start[:3], -self._step)

    @property
    def is_active(self) -> bool:
        """Whether the last step followed the momentum."""
        return self._last is not None

    def is_needed(self, spin: Array, rates: Array) -> bool:
        """Return whether the coming step follows the momentum; forget it if not.

        `spin` is that of the base, in its own axes.
        """
        _, base_to_joints = self._world.base_response()
        whole = spin + rates @ base_to_joints[:, :3]
        least = self._enter_squared if self._last is None else self._leave_squared
        if whole.dot(whole) > least:
            return True
        self._last = None
        return False

    def predict(
        self, law: SpringDamperLaw, axes: Array, motion: Array, load: Array, coming_spin: Array
    ) -> Array:
        """Have the law predict the coming step; return the forces to add to the engine's, (6 + n,).

        `axes` are those of the base, (3, 3). In these are `motion`, (6 + n,), the present
        velocities, `load`, (6,), the wrench of loads, `coming_spin`, (3,), that of the base by
        extrapolation, and the forces.
        """
        world, step, angles = self._world, self._step, law.angles.tolist()
        still = np.zeros(len(motion))
        base_rows = world.whole_mass_matrix(angles)[:6]
        contact = self._follow(axes, motion, law, base_rows)
        outside = contact + step * load
        left = _with_impulse(self._own_momentum(axes), outside, base_rows)
        present = world.inertial_forces(angles, motion, still)
        own_present = world.equivalent_joint_torques(present)
        change: Array = np.empty(len(present))
        coming = motion
        is_solved = True

        def joint_bias_at(rates: Array) -> Array:
            nonlocal is_solved
            expected = (rates - law.rates) / (0.5 * step)
            felt: Array = np.zeros(len(rates))

            def acceleration(foreseen: Array) -> Array:
                nonlocal coming, felt
                rates_after = law.rates + step * foreseen
                coming = self._motion(left, law.angles, rates_after, coming[:3], step)
                middle = world.inertial_forces(angles, 0.5 * (motion + coming), still)
                np.subtract(present, middle, change)
                change[:6] = present[:6] + (base_rows @ (coming - motion) - outside) / step
                felt = world.equivalent_joint_torques(change)
                brought: Array = expected + law.response.dot(felt)
                return brought

            found = fixed_point(acceleration, expected, _TOLERANCE / step**2, _MAX_ROUNDS)
            is_solved = found is not None
            if not is_solved:
                extrapolated = np.concatenate([coming_spin, still[:3], rates])
                np.subtract(present, world.inertial_forces(angles, extrapolated, still), change)
                felt = world.equivalent_joint_torques(change)
            return own_present - felt

        law.predict(own_present, joint_bias_at)
        foreseen = coming.copy()
        foreseen[3:6] += self._gravity_step @ axes
        last = _LastStep(axes, base_rows, foreseen, contact, outside)
        self._last = last if is_solved else None
        return change

    def _follow(self, axes: Array, motion: Array, law: SpringDamperLaw, base_rows: Array) -> Array:
        """Bring the momentum up to the present; return the impulse of contact to be expected.

        Shape (6,), in the present axes of the base.
        """
        last = self._last
        if last is not None:
            turn = last.axes.T @ axes
            actual = np.concatenate([turn @ motion[:3], turn @ motion[3:6], motion[6:]])
            off = actual - last.motion
            if self._step * float(np.abs(off[:3]).max()) < SMOOTH:
                unforeseen = last.base_rows @ off
                before = self._own_momentum(last.axes)
                own = _with_impulse(before, last.outside + unforeseen, last.base_rows)
                gravity = float(base_rows[3, 3]) * self._gravity_step
                linear, angular = last.axes @ own.linear, last.axes @ own.angular
                self._momentum = Momentum(linear + gravity, angular)
                contact = last.contact + unforeseen
                return np.concatenate([contact[:3] @ turn, contact[3:] @ turn])
        self._momentum = self._momentum_half_step_before(axes, motion, law)
        return np.zeros(6)

    def _momentum_half_step_before(
        self, axes: Array, motion: Array, law: SpringDamperLaw
    ) -> Momentum:
        """Return the momentum in the world with which the body came to where it is."""
        spin, velocity, back = motion[:3], motion[3:6], -self._step
        angles = law.angles + 0.5 * back * law.rates
        whole = WholeInertia(self._world.whole_mass_matrix(angles.tolist()), law.rates)
        own = whole.momentum(spin, turned_half_way(velocity, spin, back))
        return Momentum(
            axes @ turned_half_way(own.linear, spin, -back),
            axes @ turned_half_way(own.angular, spin, -back),
        )

    def _own_momentum(self, axes: Array) -> Momentum:
        """Return the momentum in the axes of the base."""
        return Momentum(self._momentum.linear @ axes, self._momentum.angular @ axes)

    def _motion(
        self, left: Momentum, angles: Array, rates: Array, guess: Array, step: float
    ) -> Array:
        """Return the velocities, (6 + n,), with which the body has a momentum half a step on.

        The joints have these rates, and `guess` is near the spin. All are in the axes of the base
        now; with a negative step half a step back.
        """
        matrix = self._world.whole_mass_matrix((angles + 0.5 * step * rates).tolist())
        whole = WholeInertia(matrix, rates)
        spin = whole.spin(left.angular, guess, step)
        if spin is None:  # the divergence monitor ends such a run
            spin = guess
        velocity = whole.velocity(turned_half_way(left.linear, spin, step), spin)
        return np.concatenate([spin, turned_half_way(velocity, spin, -step), rates])


def _with_impulse(momentum: Momentum, impulse: Array, base_rows: Array) -> Momentum:
    """Return a momentum once an impulse, (6,), acted on the base; all in the axes of the base."""
    mass, first_moment = base_rows[3, 3], base_rows[3:6, :3]
    # r x J, where the first moment acts as minus m r does
    about_centre = impulse[:3] - first_moment.T @ impulse[3:] / mass
    return Momentum(momentum.linear + impulse[3:], momentum.angular + about_centre)
