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

After an impact f holds the blow, which is gone a step later; the law takes it as it is. Minmod, the
median of three, a running mean, dropping or capping the change, of all of f or of its contact part
alone, made errors after blows larger or no smaller, and failed at steps at which this holds; the
bench in tests/contact shows it. Only the half step h/2 a of the bias forces must not go on with a
blow: these are quadratic, and a long chain falling on the ground took up 76 times the energy that
it had. Where bodies can touch, an a that would turn a joint far within a step, and is more than
twice the last one or against it, is limited.

Where joints would pass their limits in the expected step, a and τ get what torques λ on them do,
(M + B)⁻¹ λ and (1 - B (M + B)⁻¹) λ: see `stops`.

`SpringDamperLaw.correct` computes all of this. `SpringDamperLaw.reuse` extrapolates the last two
corrections, which is still second order, and enough where a few steps turn no joint far.

Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67; Chung and Hulbert, J. Appl. Mech. 60 (1993) 371
(why modes that are not resolved should be damped, and only they); Hairer, Lubich, Wanner,
Geometric Numerical Integration, ch. I.1.4 (leapfrog); Steihaug and Wolfbrandt, Math. Comp. 33
(1979) 521 (why an old M does no harm to the order); Tan, Liu, Turk, IEEE CG&A 31 (2011) 34 (stable
PD control).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from somo_cli.arrays import Array, invert
from somo_cli.scene.model import Integrator
from somo_cli.simulation.integrator.mode_coefficients import ModeCoefficients
from somo_cli.simulation.plan.joint_springs import JointSprings

IMPACT_RATIO = 2.0  # a change larger than this times the one before counts as an impact
SMOOTH = 5e-3  # rad: below it, a change of rate in a step, times the step, counts as smooth


def limited_change(change: Array, before: Array, small: float) -> Array:
    """Return the part of the change in the last step that may be extrapolated, shape (n,).

    `before` is the change in the step before. Changes up to `small` and those of smooth motion stay
    whole; what an impact has added is limited, number by number (a minmod).
    """
    if change.dot(change) <= small * small or float(np.abs(change).max()) <= small:
        return change
    ahead = np.sign(change) * np.minimum(np.abs(change), IMPACT_RATIO * np.abs(before))
    limited = np.where(change * before > 0, ahead, 0.0)
    return np.where(np.abs(change) > small, limited, change)


class SpringDamperLaw:
    """The law of one body, in most steps one product of a vector and a matrix.

    `state`, shape (5 n + 2,), stacks the share of a reused correction's growth, a one, u, q, v,
    v_prev and τ_prev. Write q and v into `motion`, set `actuation` when it changes, then call
    `correct`, or what `make_reuse` returns, for the torques of the coming step.
    """

    def __init__(self, springs: JointSprings, time_step: float, integrator: Integrator) -> None:
        n = len(springs.stiffness)
        self.springs = springs
        self.time_step = time_step
        self.integrator = integrator
        self.state: Array = np.zeros(5 * n + 2)
        self.state[1] = 1.0
        self.actuation, self.angles, self.rates = _blocks(self.state[2 : 3 * n + 2], 3)
        self.motion = self.state[n + 2 : 3 * n + 2]
        self._previous_rates, self._previous_torques = _blocks(self.state[3 * n + 2 :], 2)
        self.correction: Array = np.zeros(n)
        self.bias: Array | None = None  # at the start of the last step, if it was corrected
        self.limit_torques: Callable[[Array, Array], Array | None] | None = None
        """Returns the torques at joint limits from a and (M + B)⁻¹; None far from all limits."""
        self.detects_impacts = False
        """Whether impacts are to be told from smooth motion."""
        self._last_acceleration: Array | None = None
        self.predicted: Array = np.zeros(n)
        """a as `predict` left it, before joint limits and changes of contact forces."""
        self._own_share: Array | None = None  # s and corrections, likewise
        self._to_acceleration: Array = np.zeros((5 * n + 2, n))  # of the state, in held steps
        self._acceleration_of: Array | None = None  # the (M + B)⁻¹ that it was made with
        self._held_change: tuple[Array, Array] | None = None  # what is held, if it is new
        self._torques_held: Array = np.zeros(n)
        self._mass: Array | None = None
        self.coefficients = ModeCoefficients(springs, time_step, integrator)
        self._response: Array = np.zeros((n, n))  # (M + B)⁻¹
        self._implicit = self.coefficients.constant_implicit
        self._at_rest: Array = springs.stiffness * springs.neutral
        self._torques: Array = np.zeros(n)
        # arrays: numpy multiplies by them in half the time that it takes to read a float
        self._step: Array = np.array(time_step)
        self._half_step: Array = np.array(0.5 * time_step)
        self._growth_per_step = 1.0  # share of a reused correction's growth
        # memory views are copied in half the time of arrays
        self._present_views: Any = self.rates.data, self._torques.data
        self._previous_views: Any = self._previous_rates.data, self._previous_torques.data
        self._allocate_maps()

    def _allocate_maps(self) -> None:
        """Allocate s, f and the torques as linear functions of the state, a row for each number.

        In rows, what a new mass matrix or a reused correction changes is contiguous.
        """
        n = len(self.rates)
        unit = np.eye(n)
        # s, of a one, u, q and v; later only the mass matrix changes it, and f
        self._spring_map: Array = np.zeros((3 * n + 1, n))
        self._spring_map[0] = self._at_rest
        by_actuation, by_angles, self._spring_by_rates = _blocks(self._spring_map[1:], 3)
        by_actuation[:], self._spring_by_rates[:] = unit, -self.coefficients.damping
        by_angles[:] = np.diag(-self.springs.stiffness)
        self._spring_state = self.state[1 : 3 * n + 2]
        # f, of v, v_prev and τ_prev
        self._force_map: Array = np.zeros((3 * n, n))
        self._force_by_rates, self._force_by_previous, by_torques = _blocks(self._force_map, 3)
        by_torques[:] = -unit
        self._force_state = self.state[2 * n + 2 :]
        # the torques, of the whole state
        self._torque_map: Array = np.zeros((5 * n + 2, n))
        self._torque_map[1 : 3 * n + 2] = self._spring_map
        self._growth_row, self._constant_row = self._torque_map[:2]
        self._map_blocks = _blocks(self._torque_map[2:], 5)
        self._is_assembled = True  # whether the product is that of the present mass
        self._unit: Array = unit
        self._negative_stiffness: Array = -self.springs.stiffness[:, np.newaxis]

    def refresh(self, mass: Array, refreshes_implicit: bool = True) -> None:
        """Take the joint-space inertia M, shape (n, n), of the present pose.

        D + N and B may be older, which changes the result only in the third order of the step:
        they are computed anew only if `refreshes_implicit`.
        """
        if self.integrator == "explicit":
            return
        if self._mass is not None:
            # f, measured with the old matrix, must not jump
            change = self.rates - self._previous_rates
            self._previous_torques += (mass - self._mass).dot(change) / self._step
        self._mass = mass
        if refreshes_implicit:
            damping, self._implicit = self.coefficients.matrices(mass)
            np.negative(damping, self._spring_by_rates)
        np.divide(mass, self._step, self._force_by_rates)
        np.negative(self._force_by_rates, self._force_by_previous)
        self._response = invert(mass + self._implicit)
        self._is_assembled = False

    def _assemble_torque_map(self) -> None:
        """Assemble the one matrix for the present M; it pays where it serves several steps."""
        assert self._mass is not None, "refresh comes first"
        by_actuation, by_angles, by_rates, by_previous, by_torques = self._map_blocks
        # transposed, so in reverse order: B (M + B)⁻¹ and 1 - B (M + B)⁻¹
        share = self._response.dot(self._implicit, by_torques)
        rest = np.subtract(self._unit, share, by_actuation)
        np.multiply(self._negative_stiffness, rest, by_angles)
        self._force_by_rates.dot(share, by_previous)
        self._spring_by_rates.dot(rest, by_rates)
        np.subtract(by_rates, by_previous, by_rates)
        self._is_assembled = True

    def set_force(self, force: Array, bias: Array | None = None) -> None:
        """Set f, the generalised force on the joints beside the law's, as that of the last step.

        `bias` holds the bias forces at the rates for which `force` was measured.
        """
        self._previous_rates[:] = self.rates
        self._previous_torques[:] = -force
        self.bias = bias

    def measured_force(self, bias: Array) -> Array:
        """Return f of the last step, shape (n,), with the present bias forces."""
        assert self._mass is not None, "refresh comes first"
        force: Array = self._force_state.dot(self._force_map)
        if self.bias is not None:
            force += self.bias - bias
        return force

    def reuse(self, bias_decrease: Array, growth: Array, steps: int) -> None:
        """Extrapolate the last correction over the coming steps, which `make_reuse` applies.

        `bias_decrease` is the decrease of the bias forces over so many steps, shape (n,): the
        measured force is a step old, and too large by a step's share of it. `growth` is the change
        of the correction over the steps.
        """
        if not self._is_assembled:
            self._assemble_torque_map()
        rest = self._map_blocks[0]  # what actuation adds to the torques
        lag = bias_decrease / steps
        ahead = lag + self._at_rest
        ahead += self.correction
        np.subtract(ahead.dot(rest), lag, self._constant_row)
        growth.dot(rest, self._growth_row)
        self._held_change = ahead, growth
        self._growth_per_step, self.state[0] = 1 / steps, 0.0

    def make_reuse(self, apply: Callable[[list[float]], None]) -> Callable[[], None]:
        """Return the function that applies the torques of the coming step in most steps.

        Call `reuse` first after each new mass matrix. All names are bound, because a run spends its
        time here.
        """
        law, dot, to_torques = self, self.state.dot, self._torque_map
        torques, tolist = self._torques, self._torques.tolist
        share: Any = self.state[:1].data
        (rates, applied), (previous_rates, previous_torques) = (
            self._present_views,
            self._previous_views,
        )

        def apply_reused() -> None:
            share[0] += law._growth_per_step
            dot(to_torques, torques)
            previous_rates[:] = rates
            previous_torques[:] = applied
            law.bias = None
            apply(tolist())

        return apply_reused

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
        assert self._mass is not None, "refresh comes first"
        rates = self.rates
        own = self._spring_state.dot(self._spring_map)
        acceleration = self._response.dot(self.measured_force(bias) + own)
        # a joint pressed on its limit is not about to move
        limit_torques = self._limit_torques(acceleration)
        expected = (
            acceleration
            if limit_torques is None
            else acceleration + self._response.dot(limit_torques)
        )
        if self.detects_impacts:
            last, self._last_acceleration = self._last_acceleration, expected.copy()
            expected = (
                expected
                if last is None
                else limited_change(expected, last, SMOOTH / self.time_step**2)
            )
        self.correction = bias - bias_at(self._half_step * expected + rates)
        acceleration += self._response.dot(self.correction)
        own += self.correction
        self.predicted, self._own_share = acceleration, own
        self.bias = bias

    def predict_held(self) -> None:
        """Do as `predict` does, with the correction held as `make_reuse` holds it."""
        state = self.state
        state[0] += self._growth_per_step
        if self._held_change is not None:
            self._lay_acceleration(*self._held_change)
            self._held_change = None
        # τ, not s: at their limits no joints are held
        self._own_share = None
        state.dot(self._to_acceleration, self.predicted)
        state.dot(self._torque_map, self._torques_held)
        self.bias = None

    def _lay_acceleration(self, ahead: Array, growth: Array) -> None:
        """Lay down a as a linear function of the state, for corrections that are held."""
        response, laid = self._response, self._to_acceleration
        if self._acceleration_of is not response:
            self._acceleration_of = response
            by_actuation, by_angles, by_rates, by_previous, by_torques = _blocks(laid[2:], 5)
            by_actuation[:] = response
            np.multiply(self._negative_stiffness, response, by_angles)
            np.add(self._spring_by_rates, self._force_by_rates).dot(response, by_rates)
            self._force_by_previous.dot(response, by_previous)
            np.negative(response, by_torques)
        growth.dot(response, laid[0])
        ahead.dot(response, laid[1])

    def settle(self, change: Array | None = None) -> list[float]:
        """Return the torques for the expected step that was predicted.

        `change` is what changes of contact forces add to a, shape (n,).
        """
        acceleration, own, torques = self.predicted, self._own_share, self._torques
        if own is None:  # held, of which the torques are known without the change
            torques[:] = self._torques_held
            if change is not None:
                torques -= self._implicit.dot(change)
        else:
            if change is not None:
                acceleration += change
            limit_torques = self._limit_torques(acceleration)
            if limit_torques is not None:
                acceleration += self._response.dot(limit_torques)
                own += limit_torques
            np.subtract(own, self._implicit.dot(acceleration), torques)
        previous_rates, previous_torques = self._previous_views
        previous_rates[:], previous_torques[:] = self._present_views
        values: list[float] = torques.tolist()
        return values

    @property
    def response(self) -> Array:
        """(M + B)⁻¹, shape (n, n): what torques on the joints add to a."""
        return self._response

    @property
    def previous_rates(self) -> Array:
        """Joint rates before the last step, shape (n,)."""
        return self._previous_rates

    def _limit_torques(self, acceleration: Array) -> Array | None:
        """Return the torques that stop joints at their limits, None if no joint would pass one."""
        return (
            None if self.limit_torques is None else self.limit_torques(acceleration, self._response)
        )

    def rates_of_instant(self) -> Array:
        """Return the rates at the instant of the angles [rad/s], shape (n,), to second order."""
        if self.integrator != "implicit":
            return self.rates.copy()
        return 1.5 * self.rates - 0.5 * self._previous_rates

    def acceleration(self, mass: Array, force: Array) -> Array:
        """Return a = (M + B)⁻¹ (f + s) at the present state, shape (n,) [rad/s²]."""
        damping, implicit = self.coefficients.matrices(mass)
        springs = self.springs.stiffness * (self.angles - self.springs.neutral)
        s = self.actuation - springs - damping @ self.rates
        return np.asarray(np.linalg.solve(mass + implicit, force + s), dtype=np.float64)


def _blocks(rows: Array, count: int) -> list[Array]:
    """Return so many equal parts of an array, one after the other, as views."""
    return np.split(rows, count)
