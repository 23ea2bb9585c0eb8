"""The spring-damper law: joint angles and rates to torques, for the three integrators.

Bullet advances v' = v + h M⁻¹(f + τ), q' = q + h v', where f holds every force that is not ours:
gravity, Coriolis, contact, friction, constraints. With K, D diagonal and u the actuation, the
implicit law is Newmark's method in leapfrog form: v lives at half steps, the damper is centred and
the spring is evaluated at q + β h² a,

    s = u - K (q - q0) - (D + N) v
    f = M (v - v_prev) / h - τ_prev          what the engine did in the last step, measured
    a = (M + B)⁻¹ (f + s)
    τ = s - B a

At rest a = 0 and τ = s, so static equilibria are exact, contact forces included. It is second
order for every B = h/2 D + O(h²); what B is beyond that is chosen mode by mode, as a rational
function of x = h d/m and y = h² k/m:

    N = h K (1 + ε h² M⁻¹K)⁻¹ ε h² M⁻¹K                                   ε y² m/h / (1 + ε y)
    B = h/2 (D + N) + h²/12 K + P (M + P/6)⁻¹ P / 12,   P = h D + 5/6 h² K

Slow modes have β = 1/12 and (1 + x/2 + x²/12), for which Newmark's spring is of fourth order and
the damper Padé's approximation of exp(-x); in modes that the step does not resolve B tends to
h D + h² K and N to h K, which is backward Euler: they decay at once, however light their damping,
and do not flip their sign in every step, which an M that is a little old would make them grow by.

With B = h D + h² K and N = h K in all modes it is backward Euler; with B = N = 0 it is the explicit
torque loop.

Bullet evaluates Coriolis forces at v, half a step too early, which alone would leave the method
with first order; at large steps it is also what makes it fail. With c(v) the bias forces of
inverse dynamics at q, the half step is made up for by acting as if u were larger by

    c(v) - c(v + h/2 a),  and f by  c_prev - c(v), where it is a step old.

f holds gravity, too, whose stiffness G is that of a pendulum. Where a step does not resolve the
pendulum, N and B get what G would give them if it were a spring with β = 1/2, and f is left as it
is: h²/2 G is another O(h²) in B, and changes no equilibrium.

After an impact f holds its force, which is gone a step later; the law takes f as it is. Minmod,
the median of three, a running mean, dropping or capping the change, of all of f or of its contact
part alone, made errors after impacts larger or no smaller, and failed at steps at which this holds;
the bench in tests/contact shows it. Only the half step h/2 a of the bias forces must not go on with
an impact: these are quadratic, and a long chain falling on the ground took up 76 times the energy
that it had. Where bodies can touch, an a that would turn a joint far within a step, and is more
than twice the last one or against it, is limited (`impacts`).

Where joints would pass their limits in the expected step, a and τ get what torques λ on them do,
(M + B)⁻¹ λ and (1 - B (M + B)⁻¹) λ (`joint_limits`).

`SpringDamperLaw.correct` computes all of this. `reused_correction` extrapolates the last two
corrections, which is still second order, and enough where a few steps turn no joint far.

Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67; Chung and Hulbert, J. Appl. Mech. 60 (1993) 371
(why modes that are not resolved should be damped, and only they); Hairer, Lubich, Wanner,
Geometric Numerical Integration, ch. I.1.4 (leapfrog); Steihaug and Wolfbrandt, Math. Comp. 33
(1979) 521 (why an old M does no harm to the order); Tan, Liu, Turk, IEEE CG&A 31 (2011) 34 (stable
PD control).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from somo_cli.arrays import Array, invert
from somo_cli.scene.model import Integrator
from somo_cli.simulation.integrator.impacts import SMOOTH, limited_change
from somo_cli.simulation.integrator.law_state import LawState, blocks
from somo_cli.simulation.integrator.mode_coefficients import ModeCoefficients
from somo_cli.simulation.plan.joint_springs import JointSprings


class SpringDamperLaw:
    """The law of one body, in engine units.

    Write q and v into `motion`, set `actuation` when it changes, call `refresh` for a new inertia,
    then `correct` for the torques of the coming step.
    """

    def __init__(self, springs: JointSprings, time_step: float, integrator: Integrator) -> None:
        n = len(springs.stiffness)
        self.springs = springs
        self.time_step = time_step
        self.integrator = integrator
        self.state = LawState(n)
        self.actuation = self.state.actuation
        self.angles = self.state.angles
        self.rates = self.state.rates
        self.motion = self.state.motion
        self.correction: Array = np.zeros(n)
        """What the Coriolis forces of the coming half step add to the actuation, shape (n,)."""
        self.bias: Array | None = None
        """The bias forces at the start of the last step, None if it was not corrected."""
        self.limit_torques: Callable[[Array, Array], Array | None] | None = None
        """Returns the torques at joint limits from a and (M + B)⁻¹; None far from all limits."""
        self.detects_impacts = False
        """Whether impacts are to be told from smooth motion."""
        self.predicted: Array = np.zeros(n)
        """a as it was predicted, before joint limits and changes of contact forces, shape (n,)."""
        self.coefficients = ModeCoefficients(springs, time_step, integrator)
        self.response: Array = np.zeros((n, n))
        """(M + B)⁻¹, shape (n, n): what torques on the joints add to a; a new array for each M."""
        self.implicit: Array = self.coefficients.constant_implicit
        """B, shape (n, n)."""
        self._own_share: Array | None = None  # s and corrections; None if torques are known
        self._last_acceleration: Array | None = None
        self._mass: Array | None = None
        # arrays: numpy multiplies by them in half the time that it takes to read a float
        self._step: Array = np.array(time_step)
        self._half_step: Array = np.array(0.5 * time_step)
        # s of a one, u, q and v, and f of v, v_prev and τ_prev: a row for each of these numbers, in
        # rows because what a new mass matrix changes is contiguous then
        unit = np.eye(n)
        self.spring_map: Array = np.zeros((3 * n + 1, n))
        """s as a linear function of a one, u, q and v, shape (3 n + 1, n)."""
        self.spring_map[0] = springs.stiffness * springs.neutral
        by_actuation, by_angles, self._spring_by_rates = blocks(self.spring_map[1:], 3)
        by_actuation[:], self._spring_by_rates[:] = unit, -self.coefficients.damping
        by_angles[:] = np.diag(-springs.stiffness)
        self.force_map: Array = np.zeros((3 * n, n))
        """f as a linear function of v, v_prev and τ_prev, shape (3 n, n)."""
        self._force_by_rates, self._force_by_previous, by_torques = blocks(self.force_map, 3)
        by_torques[:] = -unit

    @property
    def previous_rates(self) -> Array:
        """Joint rates before the last step, shape (n,)."""
        return self.state.previous_rates

    def refresh(self, mass: Array, refreshes_implicit: bool = True) -> None:
        """Take the joint-space inertia M, shape (n, n), of the present pose.

        D + N and B may be older, which changes the result only in the third order of the step:
        they are computed anew only if `refreshes_implicit`.
        """
        if self.integrator == "explicit":
            return
        if self._mass is not None:
            # f, measured with the old matrix, must not jump
            change = self.rates - self.state.previous_rates
            self.state.previous_torques += (mass - self._mass).dot(change) / self._step
        self._mass = mass
        if refreshes_implicit:
            damping, self.implicit = self.coefficients.matrices(mass)
            np.negative(damping, self._spring_by_rates)
        np.divide(mass, self._step, self._force_by_rates)
        np.negative(self._force_by_rates, self._force_by_previous)
        self.response = invert(mass + self.implicit)

    def set_force(self, force: Array, bias: Array | None = None) -> None:
        """Set f, the generalised force on the joints beside the law's, as that of the last step.

        `bias` holds the bias forces at the rates for which `force` was measured.
        """
        self.state.previous_rates[:] = self.rates
        self.state.previous_torques[:] = -force
        self.bias = bias

    def measured_force(self, bias: Array) -> Array:
        """Return f of the last step, shape (n,), with the present bias forces."""
        assert self._mass is not None, "refresh comes first"
        force: Array = self.state.of_force.dot(self.force_map)
        if self.bias is not None:
            force += self.bias - bias
        return force

    def correct(self, bias: Array, bias_at: Callable[[Array], Array]) -> list[float]:
        """Return the torques of the coming step, with Coriolis forces at the right instant.

        `bias` holds the bias forces at the present angles and rates, shape (n,), and
        `bias_at(rates)` gives them at other rates.
        """
        self.predict(bias, bias_at)
        return self.settle()

    def predict(self, bias: Array, bias_at: Callable[[Array], Array]) -> None:
        """Work out a, and what of the torques does not depend on it; `settle` comes next.

        The arguments are those of `correct`, which does both.
        """
        own = self.state.of_springs.dot(self.spring_map)
        acceleration = self.response.dot(self.measured_force(bias) + own)
        # a joint pressed on its limit is not about to move
        limit_torques = self._limit_torques(acceleration)
        expected = (
            acceleration
            if limit_torques is None
            else acceleration + self.response.dot(limit_torques)
        )
        if self.detects_impacts:
            last, self._last_acceleration = self._last_acceleration, expected.copy()
            if last is not None:
                expected = limited_change(expected, last, SMOOTH / self.time_step**2)
        self.correction = bias - bias_at(self._half_step * expected + self.rates)
        acceleration += self.response.dot(self.correction)
        own += self.correction
        self.predicted, self._own_share = acceleration, own
        self.bias = bias

    def predict_linearly(self, to_acceleration: Array, to_torques: Array) -> None:
        """Do as `predict` does, with a and the torques linear in the state, (5 n + 2, n) each.

        Joint limits are not heeded, and the correction stays what it is.
        """
        state = self.state
        state.vector.dot(to_acceleration, self.predicted)
        state.vector.dot(to_torques, state.torques)
        self._own_share = self.bias = None

    def settle(self, change: Array | None = None) -> list[float]:
        """Return the torques for the step that was predicted.

        `change` is what changes of contact forces add to a, shape (n,).
        """
        acceleration, own, torques = self.predicted, self._own_share, self.state.torques
        if own is None:  # they are known but for the change
            if change is not None:
                torques -= self.implicit.dot(change)
        else:
            if change is not None:
                acceleration += change
            limit_torques = self._limit_torques(acceleration)
            if limit_torques is not None:
                acceleration += self.response.dot(limit_torques)
                own += limit_torques
            np.subtract(own, self.implicit.dot(acceleration), torques)
        self.state.advance()
        values: list[float] = torques.tolist()
        return values

    def rates_of_instant(self) -> Array:
        """Return the rates at the instant of the angles [rad/s], shape (n,), to second order."""
        if self.integrator != "implicit":
            return self.rates.copy()
        return 1.5 * self.rates - 0.5 * self.state.previous_rates

    def acceleration(self, mass: Array, force: Array) -> Array:
        """Return a = (M + B)⁻¹ (f + s) at the present state, shape (n,) [rad/s²]."""
        damping, implicit = self.coefficients.matrices(mass)
        springs = self.springs.stiffness * (self.angles - self.springs.neutral)
        s = self.actuation - springs - damping @ self.rates
        return np.asarray(np.linalg.solve(mass + implicit, force + s), dtype=np.float64)

    def _limit_torques(self, acceleration: Array) -> Array | None:
        """Return the torques that stop joints at their limits, None if no joint would pass one."""
        return (
            None if self.limit_torques is None else self.limit_torques(acceleration, self.response)
        )
