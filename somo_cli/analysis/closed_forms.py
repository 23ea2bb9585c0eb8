"""Closed forms of beams, dimensionless, and of single joints.

Beams are inextensible, of length 1 and flexural rigidity 1, clamped at the origin along x, and bend
towards y.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipj, ellipk, ellipkinc, exprel

from somo_cli.arrays import Array

Tip = tuple[float, float]


def small_tip_load(load: float) -> Tip:
    """Return the tip under a small force load = P L²/EI along y: the deflection is P L³/3EI.

    The difference from `tip_load` is about load³. Timoshenko, Strength of Materials I, sec. 32.
    """
    return 1.0, load / 3


def tip_load(load: float) -> Tip:
    """Return the tip under a force load = P L²/EI of any size, of constant direction y.

    Bisshopp and Drucker, Q. Appl. Math. 3 (1945) 272: with the tip's slope θ,
    k² = (1 + sin θ)/2 and sin φ = 1/(k√2), √load = K(k) - F(φ, k).
    """
    if load == 0:
        return 1.0, 0.0
    root = math.sqrt(abs(load))

    def modulus(slope: float) -> tuple[float, float]:
        # scipy's parameter is m = k²
        m = (1 + math.sin(slope)) / 2
        return m, math.asin(min(1.0, math.sqrt(0.5 / m)))

    def miss(slope: float) -> float:
        m, amplitude = modulus(slope)
        return float(ellipk(m) - ellipkinc(amplitude, m)) - root

    slope = brentq(miss, 0.0, math.pi / 2 * (1 - 1e-15), xtol=1e-15, rtol=1e-14)
    m, amplitude = modulus(slope)
    sideways = 1 - 2 / root * float(ellipe(m) - ellipeinc(amplitude, m))
    along = math.sqrt(2 * math.sin(slope) / abs(load))
    return along, math.copysign(sideways, load)


def end_moment(moment: float) -> Tip:
    """Return the tip under an end moment = M L/EI: an arc of the angle `moment` [rad]."""
    return float(np.sinc(moment / math.pi)), moment / 2 * float(np.sinc(moment / 2 / math.pi)) ** 2


def own_weight(load: float) -> Tip:
    """Return the tip under a uniformly distributed load = w L³/EI of constant direction y.

    θ'' = -load (1 - s) cos θ, θ(0) = 0, θ'(1) = 0, by shooting for the curvature at the clamp.
    """
    if load == 0:
        return 1.0, 0.0
    size = abs(load)

    def along(s: float, state: Array) -> list[float]:
        slope, curvature = state[:2]
        return [curvature, -size * (1 - s) * math.cos(slope), math.cos(slope), math.sin(slope)]

    def end(curvature: float) -> Array:
        start = [0.0, curvature, 0.0, 0.0]
        shot = solve_ivp(along, (0, 1), start, method="DOP853", rtol=1e-12, atol=1e-14)
        last: Array = shot.y[:, -1]
        return last

    curvature = brentq(lambda guess: float(end(guess)[1]), 0.0, size / 2, xtol=1e-14, rtol=1e-13)
    x, y = end(curvature)[2:]
    return float(x), math.copysign(float(y), load)


def pendulum(times: Array, frequency: float, angle: float, rate: float) -> Array:
    """Return the angles of a swinging pendulum from the vertical [rad] at times [s], shape (n,).

    θ'' = -ω² sin θ with ω the `frequency` [rad/s] of small swings; sin(θ/2) = k sn(ω t + c, k).
    Whittaker, Analytical Dynamics, sec. 44. Raises ValueError if the pendulum goes over the top.
    """
    m = math.sin(angle / 2) ** 2 + (rate / (2 * frequency)) ** 2
    if m >= 1:
        raise ValueError("the pendulum goes over the top")
    if m == 0:
        return np.zeros_like(times)
    phase = float(ellipkinc(math.asin(max(-1.0, min(1.0, math.sin(angle / 2) / math.sqrt(m)))), m))
    if rate < 0:
        phase = 2 * float(ellipk(m)) - phase
    sine = ellipj(frequency * times + phase, m)[0]
    return np.asarray(2 * np.arcsin(math.sqrt(m) * sine), dtype=np.float64)


def oscillator(
    times: Array, inertia: float, damping: float, stiffness: float, start: tuple[float, float]
) -> Array:
    """Return q of I q'' + d q' + k q = 0 [rad] at times [s]; `start` is (q, q') at zero."""
    angle, rate = start
    decay, square = damping / (2 * inertia), stiffness / inertia
    difference = decay**2 - square
    if difference < 0:
        frequency = math.sqrt(-difference)
        sine = times * np.sinc(frequency * times / math.pi)  # sin(ω t) / ω
        swing = angle * np.cos(frequency * times) + (rate + decay * angle) * sine
        return np.asarray(np.exp(-decay * times) * swing, dtype=np.float64)
    apart = math.sqrt(difference)
    slow = -square / (decay + apart)  # the slower root; the other one is slow - 2 apart
    envelope = np.exp(slow * times)
    between = times * exprel(-2 * apart * times) * envelope
    return np.asarray(angle * envelope + (rate - slow * angle) * between, dtype=np.float64)
