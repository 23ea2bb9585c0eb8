"""A straight line of torque over pressure, from measured blocked forces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from somo_cli.arrays import Array


@dataclass(frozen=True, slots=True)
class TorqueLine:
    """The line torque = per_pressure * pressure + offset, by least squares.

    The errors are half widths of 95 % confidence intervals, infinite for two points; `residuals`,
    shape (n,), are measured minus fitted torques [N·m].
    """

    per_pressure: float  # N·m/Pa
    per_pressure_error: float
    offset: float  # N·m
    offset_error: float
    residuals: Array

    @property
    def has_offset(self) -> bool:
        """Whether the offset is larger than its confidence interval."""
        return abs(self.offset) > self.offset_error

    @property
    def residual(self) -> float:
        """Root mean square of the residuals [N·m]."""
        return float(np.sqrt(np.mean(self.residuals**2)))


def line(pressures: Sequence[float], torques: Sequence[float], through_zero: bool) -> TorqueLine:
    """Return the line through n points of pressure [Pa] and torque [N·m].

    With `through_zero` the torque is zero without pressure, and one point is enough; otherwise two
    points at different pressures are needed. Draper and Smith, Applied Regression Analysis (1998),
    sec. 1.4 and 2.1.
    """
    return _line(np.asarray(pressures), np.asarray(torques), through_zero)


def _line(pressures: Array, torques: Array, through_zero: bool) -> TorqueLine:
    if through_zero:
        square = float(pressures @ pressures)
        slope = float(pressures @ torques) / square
        residuals: Array = torques - slope * pressures
        freedom = len(pressures) - 1
        spread = math.sqrt(float(residuals @ residuals) / freedom) if freedom else math.nan
        error = _infinite_if_nan(_interval_factor(freedom) * spread / math.sqrt(square))
        return TorqueLine(slope, error, 0.0, 0.0, residuals)
    (slope, offset), inverse = np.polyfit(pressures, torques, 1, cov="unscaled")
    residuals = torques - slope * pressures - offset
    freedom = len(pressures) - 2
    spread = math.sqrt(float(residuals @ residuals) / freedom) if freedom else math.nan
    errors = _interval_factor(freedom) * spread * np.sqrt(np.diag(inverse))
    return TorqueLine(
        float(slope),
        _infinite_if_nan(errors[0]),
        float(offset),
        _infinite_if_nan(errors[1]),
        residuals,
    )


def _interval_factor(freedom: int) -> float:
    """Return half width of a 95 % interval over standard error; infinite without freedom."""
    return float(stdtrit(freedom, 0.975)) if freedom > 0 else math.inf


def _infinite_if_nan(error: float) -> float:
    return math.inf if math.isnan(error) else float(error)
