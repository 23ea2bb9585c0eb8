"""Frequency and damping from a free decay.

The model is x(t) = rest + e^(-σ t) (a cos ω t + b sin ω t), the decay of one damped oscillator
(Meirovitch, Fundamentals of Vibrations, 2001, sec. 1.6 ff.).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.calibration import decay_fit

MINIMUM_POINTS = 8
MINIMUM_PERIODS = 0.9
MINIMUM_SAMPLES_PER_PERIOD = 3.9
MINIMUM_EXPLAINED_VARIANCE = 0.5
OVERDAMPED_RATIO = 0.9  # damping ratio above which fewer periods mean no swing at all

_FLAT = 1e-12  # of the largest value: what varies less is rounding
_GROWTH = 1e-9  # over the record: what grows less is rounding


class NoRingDown(ValueError):
    """The data are not the decay of one oscillator, or contain too little of it."""


@dataclass(frozen=True, slots=True)
class RingDown:
    """The oscillator that fits a decay; errors are half widths of 95 % confidence intervals.

    The errors assume noise that is independent from sample to sample. They do not contain what the
    model leaves out, such as a second mode, or damping that depends on the amplitude.
    """

    frequency: float
    """Natural frequency without damping, sqrt(ω² + σ²) [rad/s]."""
    decay: float
    """Decay rate σ [1/s]: the amplitude falls as e^(-σ t)."""
    ratio: float
    """Damping ratio, σ / frequency."""
    frequency_error: float
    decay_error: float
    ratio_error: float
    rest: float
    """Value at rest, in the unit of the values."""
    amplitude: float
    """Amplitude at the first instant, in the unit of the values."""
    residual: float
    """Root mean square of the residuals, in the unit of the values."""
    periods: float
    """Number of periods of the damped swing in the record."""
    explained: float
    """Share of the variance of the values that the fit explains."""


def ring_down(times: Array, values: Array) -> RingDown:
    """Fit one decaying swing to positions or angles, shape (n,), at times [s], shape (n,).

    The times increase strictly; they need not be evenly spaced. Raises NoRingDown for data that do
    not decay as one oscillator does.
    """
    _check_data(times, values)
    duration = float(times[-1] - times[0])
    scale, mean = float(values.std()), float(values.mean())
    t = (times - times[0]) / duration
    y = (values - mean) / scale
    fit = decay_fit.fit(t, y)
    sigma, omega, (rest, a, b), residuals = fit.sigma, fit.omega, fit.linear, fit.residuals
    undamped = math.hypot(omega, sigma)
    gradients = np.array([[sigma, omega], [undamped, 0], [omega**2, -sigma * omega]]) / undamped
    gradients[2] /= undamped**2
    errors = np.linalg.norm(gradients @ fit.error_factors, axis=1).tolist()
    found = RingDown(
        frequency=undamped / duration,
        decay=sigma / duration,
        ratio=sigma / undamped,
        frequency_error=errors[0] / duration,
        decay_error=errors[1] / duration,
        ratio_error=errors[2],
        rest=mean + scale * float(rest),
        amplitude=scale * math.hypot(a, b) * math.exp(min(sigma, 0.0)),
        residual=scale * math.sqrt(float(residuals @ residuals) / len(residuals)),
        periods=omega / (2 * math.pi),
        explained=1 - float(residuals @ residuals) / float(y @ y),
    )
    _check_fit(found, len(t), duration)
    return found


def _check_data(times: Array, values: Array) -> None:
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
        raise NoRingDown(f"{which} is not after the time before it, {first:g} s")
    if np.ptp(values) <= _FLAT * np.abs(values).max():
        raise NoRingDown(f"the values are constant, {values[0]:g}: there is no swing in the record")


def _check_fit(found: RingDown, points: int, duration: float) -> None:
    cut = "cut the record with --from/--until, or choose another column"
    if found.explained < MINIMUM_EXPLAINED_VARIANCE:
        raise NoRingDown(
            "the record does not look like one decaying swing, which explains only "
            f"{100 * found.explained:.0f} % of the data; {cut}"
        )
    if found.periods < MINIMUM_PERIODS:
        if found.ratio > OVERDAMPED_RATIO:
            raise NoRingDown(
                f"the values return to rest without a swing: the damping ratio is {found.ratio:.2g}"
            )
        few = f"the record holds {found.periods:.2g} periods of a swing"
        raise NoRingDown(f"{few}: a fit needs one or more; record for longer")
    samples = (points - 1) / found.periods
    if samples < MINIMUM_SAMPLES_PER_PERIOD:
        raise NoRingDown(
            f"the record has {samples:.2g} samples per period: a fit needs 4 or more, because "
            "with fewer the frequency is ambiguous; sample faster"
        )
    if (found.decay + found.decay_error) * duration < -_GROWTH:
        grows = f"the swing grows, by e^({-found.decay:.3g} t), and does not decay"
        raise NoRingDown(f"{grows}: something drives it; {cut}")
