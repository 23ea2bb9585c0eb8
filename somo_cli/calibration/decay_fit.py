"""Least squares of one decaying swing: rest + e^(-σ t) (a cos ω t + b sin ω t).

For a given σ and ω the other three follow from a linear fit, so the search is over two unknowns:
variable projection (Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413), with the derivative of
Kaufman (BIT 15 (1975) 49). Time runs from 0 to 1 over the record, and the values have zero mean and
unit variance, so σ and ω are per record length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import stdtrit

from somo_cli.arrays import Array

CONFIDENCE = 0.95

_DECAYS = (-3.0, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)
_STRONG = (0.7, 1.0, 2.0, 5.0)  # ω/σ where damping is so strong that a spectrum has no peak
_HALF_PERIODS = range(2, 13)
_BASIN = 1.0  # [rad] per record: starts closer than this converge to the same fit
_STARTS = 4  # starts that are followed
_FEW, _MANY = 15, 500  # evaluations: of each start, and of the best one
_PADDING = 4  # length of the Fourier transform, over that of the record
_SLOWEST, _FASTEST_GROWTH = 0.3, -60.0  # bounds of ω [rad] and σ, per record


@dataclass(frozen=True, slots=True)
class DecayFit:
    """The best fit, σ and ω per record length, and its residuals, shape (n,).

    `linear` holds rest, a and b, shape (3,). The half widths of the 95 % confidence intervals of σ
    and ω are the norms of the rows of `error_factors`, shape (2, n).
    """

    sigma: float
    omega: float
    linear: Array
    residuals: Array
    error_factors: Array


def fit(t: Array, y: Array) -> DecayFit:
    """Return the best fit to values `y` of zero mean and unit variance at times `t` from 0 to 1."""
    sigma, omega = _search(t, y)
    basis = _basis(t, sigma, omega)
    linear = _linear(basis, y)
    residuals = y - basis @ linear
    factors = _error_factors(t, sigma, omega, linear, residuals)
    return DecayFit(sigma, omega, linear, residuals, factors)


def _basis(t: Array, sigma: float, omega: float) -> Array:
    """Return the three functions in which the model is linear, shape (n, 3).

    For a growing swing they are scaled to 1 at the end, not at the start, so that none overflows.
    """
    envelope = np.exp(-sigma * t if sigma >= 0 else sigma * (1 - t))
    swing = (envelope * np.cos(omega * t), envelope * np.sin(omega * t))
    return np.stack((np.ones_like(t), *swing), axis=1)


def _linear(basis: Array, y: Array) -> Array:
    """Return the least-squares rest, a and b, shape (3,)."""
    return np.asarray(np.linalg.lstsq(basis, y, rcond=None)[0], dtype=np.float64)


def _slopes(t: Array, basis: Array, omega: float, linear: Array) -> Array:
    """Return the derivatives of the model by σ and ω at constant rest, a and b, shape (n, 2)."""
    _, a, b = linear
    cosine, sine = basis[:, 1], basis[:, 2]
    return np.stack((-t * (a * cosine + b * sine), t * (b * cosine - a * sine)), axis=1)


def _search(t: Array, y: Array) -> tuple[float, float]:
    """Return σ and ω of the best fit, per record length."""

    def residuals(x: Array) -> Array:
        basis = _basis(t, x[1], math.exp(x[0]))
        return np.asarray(y - basis @ _linear(basis, y), dtype=np.float64)

    def jacobian(x: Array) -> Array:
        omega = math.exp(x[0])
        basis = _basis(t, x[1], omega)
        slopes = _slopes(t, basis, omega, _linear(basis, y))[:, ::-1] * [omega, 1.0]
        inner = np.linalg.lstsq(basis, slopes, rcond=None)[0]
        return np.asarray(basis @ inner - slopes, dtype=np.float64)

    # half the mean sampling rate: a few samples that lie close could be fitted by any higher one
    fastest = math.pi * (len(t) - 1)
    bounds = ([math.log(_SLOWEST), _FASTEST_GROWTH], [math.log(fastest), fastest])
    starts = [
        np.array([math.log(omega), sigma])
        for sigma, omega in _candidates(t, y)
        if _SLOWEST < omega < fastest and sigma < fastest
    ]
    starts.sort(key=lambda x: float(np.sum(residuals(x) ** 2)))

    def follow(start: Array, most: int) -> OptimizeResult:
        return least_squares(
            residuals, start, jacobian, bounds, "trf", 1e-15, 1e-13, 1e-15, max_nfev=most
        )

    # a few steps show which start is best; a bad one would take many steps to converge
    fits = [follow(start, _FEW) for start in _distinct_starts(starts)[:_STARTS]]
    best = follow(min(fits, key=lambda fit: float(fit.cost)).x, _MANY)
    return float(best.x[1]), math.exp(best.x[0])


def _distinct_starts(starts: list[Array]) -> list[Array]:
    """Return the starts, best first, without those close to a better one."""
    found: list[Array] = []
    for start in starts:
        omega = math.exp(start[0])
        width = _BASIN + 0.5 * abs(start[1])
        if all(abs(omega - math.exp(one[0])) > width for one in found):
            found.append(start)
    return found


def _candidates(t: Array, y: Array) -> list[tuple[float, float]]:
    """Return pairs of σ and ω to start from, per record length.

    For each σ: some multiples of it, and the peak of the spectrum of e^(-σ t) y, in which a swing
    of that decay is largest. Besides, some numbers of half periods, since the spectrum of few
    uneven samples is poor.
    """
    even = np.linspace(0.0, 1.0, len(t))
    x = np.interp(even, t, y)
    x_late = x - x[-(len(x) // 4) :].mean()
    found = [(1.0, half * math.pi) for half in _HALF_PERIODS]
    for sigma in _DECAYS:
        window = np.exp(-abs(sigma) * (even if sigma >= 0 else 1 - even))
        x_mean = x - np.average(x, weights=window)
        omegas = [_peak(window * x_mean), _peak(window * x_late)]
        omegas += [ratio * sigma for ratio in _STRONG]
        found += [(sigma, omega) for omega in omegas]
    return found


def _peak(x: Array) -> float:
    """Return ω of the largest Fourier coefficient of evenly spaced samples, per record length."""
    length = _PADDING * len(x)
    spectrum = np.abs(np.fft.rfft(x, length))
    step = 2 * math.pi * (len(x) - 1) / length
    return float(step * np.argmax(spectrum[1:]) + step)


def _error_factors(t: Array, sigma: float, omega: float, linear: Array, residuals: Array) -> Array:
    """Return a square root of the covariance of σ and ω, times Student's t, shape (2, n)."""
    basis = _basis(t, sigma, omega)
    jacobian = np.concatenate((_slopes(t, basis, omega, linear), basis), axis=1)
    freedom = len(t) - jacobian.shape[1]
    sizes = np.linalg.norm(jacobian, axis=0)
    sizes[sizes == 0] = 1.0
    inverse = np.linalg.pinv(jacobian / sizes)[:2] / sizes[:2, None]
    factor = float(stdtrit(freedom, 0.5 + CONFIDENCE / 2))
    return np.asarray(factor * math.sqrt(float(residuals @ residuals) / freedom) * inverse)
