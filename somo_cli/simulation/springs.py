"""The spring-damper law: joint angles and rates to torques, for the three integrators.

Bullet advances v' = v + h M⁻¹(f + τ), q' = q + h v', where f holds every force that is not ours:
gravity, Coriolis, contact, friction, constraints. With K, D diagonal and u the actuation, the
implicit law is Newmark's method in leapfrog form: v lives at half steps, the damper is centred and
the spring is evaluated at q + β h² a,

    B = h/2 D + β h² K
    s = u - K (q - q0) - D v
    f = M (v - v_prev) / h - τ_prev          what the engine did in the last step, measured
    a = (M + B)⁻¹ (f + s)
    τ = s - B a

It is second order for every β and, for β ≥ 1/4, stable for any step on the linear chain. At rest
a = 0 and τ = s, so static equilibria are exact, contact forces included. With B = h D + h² K and
s = u - K (q - q0) - (D + h K) v it is backward Euler; with B = 0 it is the explicit torque loop.

β is 0.3 while h ω_max < 10 and 1/2 beyond, once for each body: the smaller one halves the error,
the larger one withstands stiff springs whose neighbours move fast (measured, see README).

Bullet evaluates Coriolis forces at v, half a step too early, which alone would leave the method
with first order; at large steps it is also what makes it fail. With c(v) the bias forces of
inverse dynamics at q, the half step is made up for by acting as if u were larger by

    c(v) - c(v + h/2 a),  and f by  c_prev - c(v), where it is a step old.

`advance_corrected` does so in full; `advance` holds the last correction, which is enough (and
still second order) where a few steps turn no joint far.

Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67; Hairer, Lubich, Wanner, Geometric Numerical
Integration, ch. I.1.4 (leapfrog); Steihaug and Wolfbrandt, Math. Comp. 33 (1979) 521 (why an old
M does no harm to the order); Tan, Liu, Turk, IEEE CG&A 31 (2011) 34 (stable PD control).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from somo_cli.simulation.scene import Integrator

Array: TypeAlias = npt.NDArray[np.float64]

BETA_ACCURATE = 0.3
BETA_ROBUST = 0.5
RESOLVED = 10.0  # h ω_max below which β = 0.3 was stable in every case tried


@dataclass(frozen=True, slots=True)
class Springs:
    """Stiffness [N·m/rad], damping [N·m·s/rad] and neutral angle [rad] of every joint, shape (n,).

    In the units of the engine.
    """

    stiffness: Array
    damping: Array
    neutral: Array

    def torques(self, angles: Array, rates: Array) -> Array:
        """Return -K (q - q0) - D v, shape (n,)."""
        return -self.stiffness * (angles - self.neutral) - self.damping * rates

    def energy(self, angles: Array) -> float:
        """Return the energy stored in the springs."""
        return float(0.5 * self.stiffness @ (angles - self.neutral) ** 2)


class SpringLaw:
    """The law of one body as one matrix-vector product a step.

    `state` stacks q, v, v_prev, τ_prev, the load u and a one, shape (5 n + 1,): write q and v, set
    `actuation` when it changes, then call `advance` or `advance_corrected`.
    """

    def __init__(self, springs: Springs, time_step: float, integrator: Integrator) -> None:
        n = len(springs.stiffness)
        self.springs = springs
        self.time_step = time_step
        self.integrator = integrator
        self.state: Array = np.zeros(5 * n + 1)
        self.state[-1] = 1.0
        self.angles = self.state[:n]
        self.rates = self.state[n : 2 * n]
        self._previous_rates = self.state[2 * n : 3 * n]
        self._previous_torques = self.state[3 * n : 4 * n]
        self._load = self.state[4 * n : 5 * n]  # actuation and correction
        self._actuation: Array = np.zeros(n)
        self._correction: Array = np.zeros(n)
        self._previous_bias: Array | None = None
        # torques above, half a step's change of the rates below
        self._matrix: Array = np.zeros((2 * n, 5 * n + 1))
        self._torque_rows = self._matrix[:n]
        self._rest: Array = np.eye(n)
        self._mass: Array | None = None
        self._torques: Array = np.zeros(n)
        self._both: Array = np.zeros(2 * n)
        self._beta: float | None = None

    @property
    def actuation(self) -> Array:
        """Actuation torques u, shape (n,)."""
        return self._actuation

    @actuation.setter
    def actuation(self, torques: Array) -> None:
        self._actuation[:] = torques
        np.add(self._actuation, self._correction, self._load)

    def refresh(self, mass: Array) -> None:
        """Take the joint-space inertia M, shape (n, n), of the present pose."""
        n, h = len(self.springs.stiffness), self.time_step
        k, d = self.springs.stiffness, self.springs.damping
        if self._beta is None:
            self._beta = newmark_beta(mass, k, h)
        if self._mass is not None:
            # f, measured with the old matrix, shall not jump
            change = (mass - self._mass) @ (self.rates - self._previous_rates)
            self._previous_torques += change / h
        self._mass = mass
        implicit = self.implicit_inertia()
        inverse = np.linalg.inv(mass + np.diag(implicit))
        response = implicit[:, np.newaxis] * inverse  # R = B (M + B)⁻¹
        rest = -response
        rest.flat[:: n + 1] += 1.0
        damping = d + h * k if self.integrator == "euler" else d
        blocks = ((self._torque_rows, rest, -response), (self._matrix[n:], inverse, inverse))
        for rows, on_s, on_f in blocks:
            measured = on_f @ mass
            measured /= h
            rows[:, :n] = on_s * -k
            rows[:, n : 2 * n] = on_s * -damping + measured
            rows[:, 2 * n : 3 * n] = -measured
            rows[:, 3 * n : 4 * n] = -on_f
            rows[:, 4 * n : 5 * n] = on_s
            rows[:, 5 * n] = on_s @ (k * self.springs.neutral)
        self._matrix[n:] *= 0.5 * h
        self._rest = rest

    def implicit_inertia(self) -> Array:
        """Return the diagonal of B, shape (n,); zero for the explicit law."""
        h, k, d = self.time_step, self.springs.stiffness, self.springs.damping
        if self.integrator == "explicit":
            return np.zeros_like(k)
        if self.integrator == "euler":
            return h * d + h * h * k
        assert self._beta is not None, "refresh comes first"
        return 0.5 * h * d + self._beta * h * h * k

    def measure(self, force: Array, bias: Array | None = None) -> None:
        """Take f, the generalised force on the joints that is not ours, as the last step's.

        `bias` holds the bias forces at the rates for which `force` was measured.
        """
        self._previous_rates[:] = self.rates
        self._previous_torques[:] = -force
        self._previous_bias = bias

    def advance(self) -> list[float]:
        """Return the torques for the coming step and remember what the next one needs."""
        torques = self._torques
        self._torque_rows.dot(self.state, torques)
        self._previous_rates[:] = self.rates
        self._previous_torques[:] = torques
        self._previous_bias = None
        values: list[float] = torques.tolist()
        return values

    def advance_corrected(self, bias_at: Callable[[Array], Array]) -> list[float]:
        """Return the torques for the coming step, with Coriolis forces at the right instant.

        `bias_at(rates)` gives the bias forces at the present angles, shape (n,).
        """
        n = len(self._torques)
        bias = bias_at(self.rates)
        if self._previous_bias is not None:
            self._previous_torques -= self._previous_bias - bias
        self._load[:] = self._actuation
        self._matrix.dot(self.state, self._both)
        np.subtract(bias, bias_at(self.rates + self._both[n:]), self._correction)
        self._rest.dot(self._correction, self._torques)
        self._torques += self._both[:n]
        self._load += self._correction
        self._previous_rates[:] = self.rates
        self._previous_torques[:] = self._torques
        self._previous_bias = bias
        values: list[float] = self._torques.tolist()
        return values

    def acceleration(self, mass: Array, force: Array) -> Array:
        """Return a = (M + B)⁻¹ (f + s) at the present state, shape (n,) [rad/s²]."""
        s = self._actuation + self.springs.torques(self.angles, self.rates)
        if self.integrator == "euler":
            s -= self.time_step * self.springs.stiffness * self.rates
        return np.linalg.solve(mass + np.diag(self.implicit_inertia()), force + s)


def newmark_beta(mass: Array, stiffness: Array, time_step: float) -> float:
    """Return β: 0.3 where the step nearly resolves the stiffest mode, else 1/2."""
    fastest = natural_frequencies(mass, stiffness)[-1]
    return BETA_ACCURATE if time_step * fastest < RESOLVED else BETA_ROBUST


def natural_frequencies(mass: Array, stiffness: Array) -> Array:
    """Return the undamped natural frequencies [rad/s], lowest first, of M q'' + K q = 0."""
    scale = 1 / np.sqrt(np.diag(mass))
    root = np.linalg.cholesky(mass * np.outer(scale, scale))
    weighted = np.linalg.solve(root, np.diag(stiffness * scale * scale))
    symmetric = np.linalg.solve(root, weighted.T)
    return np.sqrt(np.maximum(np.linalg.eigvalsh((symmetric + symmetric.T) / 2), 0.0))


def largest_explicit_step(mass: Array, stiffness: Array, damping: Sequence[float] | Array) -> float:
    """Return the largest stable step [s] of the explicit law; infinity without springs.

    The linearised chain is stable exactly while 4 M - 2 h D - h² K, the characteristic matrix
    M (z - 1)² + h D (z - 1) + h² K z at z = -1, is positive definite.
    """
    d, k = np.diag(np.asarray(damping)), np.diag(stiffness)
    if not (d.any() or k.any()):
        return float("inf")

    def is_stable(h: float) -> bool:
        return bool(np.linalg.eigvalsh(4 * mass - 2 * h * d - h * h * k)[0] > 0)

    low, high = 0.0, 1.0
    while is_stable(high):
        low, high = high, 2 * high
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return low
