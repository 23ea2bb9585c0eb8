"""From a free decay to frequency and damping.

The model is x(t) = rest + e^(-σ t) (a cos ω t + b sin ω t), the decay of one damped oscillator
(Meirovitch, Fundamentals of Vibrations, 2001, sec. 1.6 ff.). For a given σ and ω the other three
are a linear fit, so only two are searched for: variable projection (Golub and Pereyra, SIAM J.
Numer. Anal. 10 (1973) 413), with the derivative of Kaufman (BIT 15 (1975) 49).

Inside, time runs from 0 to 1 over the record, and the values have no mean and unit variance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import stdtrit

from somo_cli.arrays import Array

MINIMUM_POINTS = 8
MINIMUM_PERIODS = 0.9
MINIMUM_SAMPLES_PER_PERIOD = 3.9  # in a period
MINIMUM_EXPLAINED_VARIANCE = 0.5
OVERDAMPED_RATIO = 0.9  # ratio of a damping
CONFIDENCE = 0.95

_FLAT = 1e-12  # of the largest value: what varies less is rounding
_GROWTH = 1e-9  # over the record: what grows less is rounding
_DECAYS = (-3.0, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)
_STRONG = (0.7, 1.0, 2.0, 5.0)  # ω/σ where damping is so strong that a spectrum has no peak
_HALF_PERIODS = range(2, 13)
_BASIN = 1.0  # [rad] per record
_STARTS = 4  # of them are followed to their end
_FEW, _MANY = 15, 500  # steps
_PADDING = 4
_SLOWEST, _FASTEST_GROWTH = 0.3, -60.0  # [rad], [1]: bounds of the search, per record


class NoRingDown(ValueError):
    """The data are not the decay of one oscillator, or too little of it."""


@dataclass(frozen=True, slots=True)
class RingDown:
    """What a decay tells; the errors are half widths of confidence intervals of 95 %.

    They hold for noise that is independent from sample to sample; what is not in the model, like a
    second mode or a damping that changes with the amplitude, is not in them.
    """

    frequency: float
    """Of the undamped oscillator, sqrt(ω² + σ²) [rad/s]."""
    decay: float
    """σ [1/s]: the swing falls as e^(-σ t)."""
    ratio: float
    """Of the damping to the critical one, σ/frequency."""
    frequency_error: float
    decay_error: float
    ratio_error: float
    rest: float
    """Where it comes to rest, in the unit of the values."""
    amplitude: float
    """Of the envelope at the first instant, in the unit of the values."""
    residual: float
    """Root mean square of what the fit leaves, in the unit of the values."""
    periods: float
    """How many periods of the damped swing the record holds."""
    explained: float
    """The share of the variance of the values that is the fit's."""


def ring_down(times: Array, values: Array) -> RingDown:
    """Fit one decaying swing to positions or angles, shape (n,), at times [s], shape (n,).

    The times rise strictly but need not be even. Raises NoRingDown where the data are no decay.
    """
    _refuse_bad_data(times, values)
    duration = float(times[-1] - times[0])
    scale, mean = float(values.std()), float(values.mean())
    t = (times - times[0]) / duration
    y = (values - mean) / scale
    sigma, omega = _search(t, y)
    basis = _basis(t, sigma, omega)
    linear = _linear(basis, y)
    left = y - basis @ linear
    error_factors = _error_factors(t, sigma, omega, linear, left)
    undamped = math.hypot(omega, sigma)
    gradients = np.array([[sigma, omega], [undamped, 0], [omega**2, -sigma * omega]]) / undamped
    gradients[2] /= undamped**2
    errors = np.linalg.norm(gradients @ error_factors, axis=1).tolist()
    found = RingDown(
        frequency=undamped / duration,
        decay=sigma / duration,
        ratio=sigma / undamped,
        frequency_error=errors[0] / duration,
        decay_error=errors[1] / duration,
        ratio_error=errors[2],
        rest=mean + scale * float(linear[0]),
        amplitude=scale * math.hypot(linear[1], linear[2]) * math.exp(min(sigma, 0.0)),
        residual=scale * math.sqrt(float(left @ left) / len(left)),
        periods=omega / (2 * math.pi),
        explained=1 - float(left @ left) / float(y @ y),
    )
    _refuse_bad_fit(found, len(t), duration)
    return found


def _refuse_bad_data(times: Array, values: Array) -> None:
    if times.ndim != 1 or times.shape != values.shape:
        raise NoRingDown(f"there are times of shape {times.shape}, values of shape {values.shape}")
    if len(times) < MINIMUM_POINTS:
        raise NoRingDown(
            f"the record has {len(times)} points: a fit needs {MINIMUM_POINTS} or more"
        )
    for name, data in (("time", times), ("value", values)):
        bad = np.flatnonzero(~np.isfinite(data))
        if len(bad):
            raise NoRingDown(f"{name} {bad[0] + 1} of the record is {data[bad[0]]}")
    back = np.flatnonzero(np.diff(times) <= 0)
    if len(back):
        first, second = times[back[0]], times[back[0] + 1]
        which = f"time {back[0] + 2} of the record, {second:g} s,"
        raise NoRingDown(f"{which} is not after the one before it, {first:g} s")
    if np.ptp(values) <= _FLAT * np.abs(values).max():
        raise NoRingDown(f"the values are constant, {values[0]:g}: there is no swing in the record")


def _refuse_bad_fit(found: RingDown, points: int, duration: float) -> None:
    cut = "cut the record with --from/--until, or choose another column"
    if found.explained < MINIMUM_EXPLAINED_VARIANCE:
        raise NoRingDown(
            "the record does not look like one decaying swing: it explains only "
            f"{100 * found.explained:.0f} % of the data; {cut}"
        )
    if found.periods < MINIMUM_PERIODS:
        if found.ratio > OVERDAMPED_RATIO:
            raise NoRingDown(
                f"the values creep back and do not swing: the damping ratio is {found.ratio:.2g}"
            )
        few = f"the record holds {found.periods:.2g} periods of a swing"
        raise NoRingDown(f"{few}: a fit needs one or more; record for longer")
    samples = (points - 1) / found.periods
    if samples < MINIMUM_SAMPLES_PER_PERIOD:
        raise NoRingDown(
            f"the record has {samples:.2g} samples per period: a fit needs 4 or more, because "
            "with fewer the frequency may be another one; sample faster"
        )
    if (found.decay + found.decay_error) * duration < -_GROWTH:
        grows = f"the swing grows, by e^({-found.decay:.3g} t), and does not decay"
        raise NoRingDown(f"{grows}: something drives it; {cut}")


def _basis(t: Array, sigma: float, omega: float) -> Array:
    """Return the three functions that the fit is linear in, shape (n, 3).

    Of a growing swing they are 1 at the end, not at the start, so that none overflows.
    """
    envelope = np.exp(-sigma * t if sigma >= 0 else sigma * (1 - t))
    swing = (envelope * np.cos(omega * t), envelope * np.sin(omega * t))
    return np.stack((np.ones_like(t), *swing), axis=1)


def _linear(basis: Array, y: Array) -> Array:
    """Return rest, a and b, shape (3,)."""
    return np.asarray(np.linalg.lstsq(basis, y, rcond=None)[0], dtype=np.float64)


def _slopes(t: Array, basis: Array, omega: float, linear: Array) -> Array:
    """Return how the fit changes with σ and with ω while the linear three stay, shape (n, 2)."""
    _, a, b = linear
    cosine, sine = basis[:, 1], basis[:, 2]
    return np.stack((-t * (a * cosine + b * sine), t * (b * cosine - a * sine)), axis=1)


def _search(t: Array, y: Array) -> tuple[float, float]:
    """Return σ and ω of the best fit, per record."""

    def left(x: Array) -> Array:
        basis = _basis(t, x[1], math.exp(x[0]))
        return np.asarray(y - basis @ _linear(basis, y), dtype=np.float64)

    def change(x: Array) -> Array:
        omega = math.exp(x[0])
        basis = _basis(t, x[1], omega)
        slopes = _slopes(t, basis, omega, _linear(basis, y))[:, ::-1] * [omega, 1.0]
        inner = np.linalg.lstsq(basis, slopes, rcond=None)[0]
        return np.asarray(basis @ inner - slopes, dtype=np.float64)

    # of the mean spacing: samples that happen to lie close could follow anything faster
    fastest = math.pi * (len(t) - 1)
    bounds = ([math.log(_SLOWEST), _FASTEST_GROWTH], [math.log(fastest), fastest])
    starts = [
        np.array([math.log(omega), sigma])
        for sigma, omega in _candidates(t, y)
        if _SLOWEST < omega < fastest and sigma < fastest
    ]
    starts.sort(key=lambda x: float(np.sum(left(x) ** 2)))

    def follow(start: Array, most: int) -> OptimizeResult:
        return least_squares(left, start, change, bounds, "trf", 1e-15, 1e-13, 1e-15, max_nfev=most)

    # few steps tell the best, and those in a wrong place would wander about for long
    fits = [follow(start, _FEW) for start in _distinct_starts(starts)[:_STARTS]]
    best = follow(min(fits, key=lambda fit: float(fit.cost)).x, _MANY)
    return float(best.x[1]), math.exp(best.x[0])


def _distinct_starts(starts: list[Array]) -> list[Array]:
    """Return the starts, best first, without those that would lead where a better one leads."""
    found: list[Array] = []
    for start in starts:
        omega = math.exp(start[0])
        width = _BASIN + 0.5 * abs(start[1])
        if all(abs(omega - math.exp(one[0])) > width for one in found):
            found.append(start)
    return found


def _candidates(t: Array, y: Array) -> list[tuple[float, float]]:
    """Return pairs of σ and ω to start from, per record.

    For each σ multiples of it, and the peak of the spectrum of e^(-σ t) y, where a swing of that
    decay stands out most; and some half periods, since few uneven samples have no good spectrum.
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
    """Return ω of the largest Fourier coefficient of even samples, per record."""
    length = _PADDING * len(x)
    spectrum = np.abs(np.fft.rfft(x, length))
    step = 2 * math.pi * (len(x) - 1) / length
    return float(step * np.argmax(spectrum[1:]) + step)


def _error_factors(t: Array, sigma: float, omega: float, linear: Array, left: Array) -> Array:
    """Return the root of the covariance of σ and ω, times Student's t, shape (2, n)."""
    basis = _basis(t, sigma, omega)
    jacobian = np.concatenate((_slopes(t, basis, omega, linear), basis), axis=1)
    freedom = len(t) - jacobian.shape[1]
    sizes = np.linalg.norm(jacobian, axis=0)
    sizes[sizes == 0] = 1.0
    inverse = np.linalg.pinv(jacobian / sizes)[:2] / sizes[:2, None]
    factor = float(stdtrit(freedom, 0.5 + CONFIDENCE / 2))
    return np.asarray(factor * math.sqrt(float(left @ left) / freedom) * inverse)
