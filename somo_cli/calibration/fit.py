"""Parameters from a recorded motion: nonlinear least squares over simulations of a scene.

Bates and Watts, Nonlinear Regression Analysis and Its Applications (1988), ch. 2: the covariance
of the estimate is s² (J'J)⁻¹, with the Jacobian J of the recorded values and the variance s² of the
residuals. It holds for noise that is independent from row to row.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares
from scipy.special import stdtrit

from somo_cli.analysis.recorded_run import OpenWorld, record_rows
from somo_cli.arrays import Array
from somo_cli.calibration.measurement import Measurement, scene_recording
from somo_cli.calibration.parameters import Parameter, with_factors
from somo_cli.problems import SimulationDiverged
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan

STEP = 1e-3  # of unknowns, in finite differences: far above the noise of a run, far below 1
_MAX_UNKNOWN = 7.0  # a factor of a thousand
_DIVERGED_RESIDUAL = 1e3  # weighted residual that stands for a diverged run
_INSENSITIVE = 1e-5  # effect of a parameter, over the largest, that data cannot show

Progress: TypeAlias = Callable[[int], None]


class NothingToFit(ValueError):
    """The recorded values depend on none of the parameters."""


@dataclass(frozen=True, slots=True)
class FitResult:
    """The parameters that fit the data best.

    `factors` multiply the guesses; `errors`, half widths of 95 % confidence intervals, have the
    units of the parameters; both have shape (p,). `correlation` of the estimates has shape (p, p).
    `insensitive` parameters are not fitted: they do not affect the data and keep their guess.
    `residuals` are measured minus simulated values, shape (rows, columns), in the units of the
    data, `first_residuals` those of the guess; `runs` is the number of simulations.
    """

    parameters: tuple[Parameter, ...]
    factors: Array
    errors: Array
    correlation: Array
    insensitive: tuple[Parameter, ...]
    residuals: Array
    first_residuals: Array
    runs: int

    @property
    def values(self) -> Array:
        """The fitted parameters, shape (p,), in their own units."""
        guesses: Array = np.array([one.guess for one in self.parameters])
        return guesses * self.factors

    @property
    def residual_rms(self) -> Array:
        """Root mean square of the residuals of each column, shape (columns,)."""
        squares: Array = np.sqrt(np.mean(self.residuals**2, axis=0))
        return squares

    @property
    def first_residual_rms(self) -> Array:
        """Root mean square of the residuals of the guess, shape (columns,)."""
        squares: Array = np.sqrt(np.mean(self.first_residuals**2, axis=0))
        return squares

    @property
    def autocorrelation(self) -> float:
        """Largest autocorrelation of the residuals of a column, at a lag of one row.

        Near zero for noise; near one where the model does not follow the measurement.
        """
        centred = self.residuals - self.residuals.mean(axis=0)
        squares = np.sum(centred**2, axis=0)
        lagged = np.sum(centred[1:] * centred[:-1], axis=0)
        return float(
            np.max(np.divide(lagged, squares, out=np.zeros_like(lagged), where=squares > 0))
        )


class SceneModel:
    """The columns that a scene records at the times of a measurement, for any parameters."""

    def __init__(
        self, scene: Scene, measurement: Measurement, open_world: OpenWorld, progress: Progress
    ) -> None:
        self._steps, every = _stride(measurement.times, scene.time_step)
        whole = scene_recording(scene, measurement.quantities)
        self._scene = dataclasses.replace(whole, every=every)
        self._recording = measurement
        self._open_world = open_world
        self._progress = progress
        self._latest: tuple[Sequence[Parameter], bytes, Array] | None = None
        self.runs = 0

    def at(self, known: Sequence[Parameter], unknowns: Array) -> Array:
        """Return the recorded columns, shape (rows, columns), in SI. Raises SimulationDiverged."""
        key = unknowns.tobytes()
        if self._latest is not None and self._latest[:2] == (known, key):
            return self._latest[2]
        plan = make_plan(with_factors(self._scene, known, unknowns))
        rows = record_rows(plan, self._steps, self._open_world)
        self.runs += 1
        self._progress(self.runs)
        columns = rows[:, list(self._recording.places)]
        values: Array = CubicSpline(rows[:, 0], columns, axis=0)(self._recording.times)
        self._latest = (known, key, values)
        return values

    def slopes(self, known: Sequence[Parameter], unknowns: Array) -> Array:
        """Return finite differences by the unknowns, shape (rows, columns, p)."""
        here = self.at(known, unknowns)
        changes = STEP * np.eye(len(known))
        slopes: Array = np.stack(
            [(self.at(known, unknowns + change) - here) / STEP for change in changes], axis=-1
        )
        self._latest = (known, unknowns.tobytes(), here)
        return slopes


def _stride(times: Array, step: float) -> tuple[int, int]:
    """Return the number of steps to the last time [s], and the steps from row to row.

    If all times are whole multiples of the step, only rows at these times are recorded.
    """
    numbers = np.rint(times / step).astype(int)
    if np.abs(times / step - numbers).max() < 1e-6 and numbers[-1] > 0:
        return int(numbers[-1]), int(np.gcd.reduce(numbers))
    return max(1, int(np.ceil(times[-1] / step))), 1


def fit(model: SceneModel, measurement: Measurement, known: Sequence[Parameter]) -> FitResult:
    """Return the parameters with which the scene follows the measurement best.

    Each quantity is weighted by the inverse of its scatter: in a first fit that of the data, in a
    second one that of the residuals. Raises NothingToFit, and SimulationDiverged if the scene
    diverges with the guess.
    """
    start = np.zeros(len(known))
    first = measurement.values - model.at(known, start)
    weights = measurement.weights(measurement.values - measurement.values.mean(axis=0))
    effects = np.sqrt(np.mean((model.slopes(known, start) * weights[:, np.newaxis]) ** 2, (0, 1)))
    sensitive = effects > _INSENSITIVE * effects.max()
    if not sensitive.any():
        raise NothingToFit("no recorded value depends on the parameters")
    chosen = [one for one, is_sensitive in zip(known, sensitive, strict=True) if is_sensitive]
    unknowns = _least_squares_solution(model, measurement, chosen, weights, np.zeros(len(chosen)))
    if len(measurement.quantities) > 1:
        weights = measurement.weights(measurement.values - model.at(chosen, unknowns))
        unknowns = _least_squares_solution(model, measurement, chosen, weights, unknowns)
    residuals = measurement.values - model.at(chosen, unknowns)
    slopes = (model.slopes(chosen, unknowns) * weights[:, np.newaxis]).reshape(-1, len(chosen))
    covariance = _covariance(slopes, (residuals * weights).ravel())
    deviations = np.sqrt(np.diag(covariance))
    pairs = list(zip(chosen, unknowns.tolist(), strict=True))
    spread = np.array([one.guess * one.spread(unknown) for one, unknown in pairs])
    freedom = max(1, residuals.size - len(chosen))
    return FitResult(
        parameters=tuple(chosen),
        factors=np.array([one.factor(unknown) for one, unknown in pairs]),
        errors=float(stdtrit(freedom, 0.975)) * spread * deviations,
        correlation=covariance / np.outer(deviations, deviations),
        insensitive=tuple(
            one for one, is_sensitive in zip(known, sensitive, strict=True) if not is_sensitive
        ),
        residuals=residuals,
        first_residuals=first,
        runs=model.runs,
    )


def _least_squares_solution(
    model: SceneModel,
    measurement: Measurement,
    known: Sequence[Parameter],
    weights: Array,
    start: Array,
) -> Array:
    def residuals(unknowns: Array) -> Array:
        try:
            simulated = model.at(known, unknowns)
        except SimulationDiverged:
            return np.full(measurement.values.size, _DIVERGED_RESIDUAL)
        difference: Array = (simulated - measurement.values) * weights
        return difference.ravel()

    def slopes(unknowns: Array) -> Array:
        derivatives = model.slopes(known, unknowns) * weights[:, np.newaxis]
        return derivatives.reshape(-1, len(known))

    found = least_squares(
        residuals,
        start,
        jac=slopes,
        bounds=(-_MAX_UNKNOWN, _MAX_UNKNOWN),
        xtol=1e-6,
        ftol=1e-9,
        gtol=1e-12,
    )
    solution: Array = found.x
    return solution


def _covariance(slopes: Array, residuals: Array) -> Array:
    """Return s² (J'J)⁻¹, shape (p, p); very large for combinations that the data do not show."""
    freedom = max(1, len(residuals) - slopes.shape[1])
    variance = max(float(residuals @ residuals), 1e-30) / freedom
    scale = np.maximum(np.linalg.norm(slopes, axis=0), 1e-300)
    _, values, rows = np.linalg.svd(slopes / scale, full_matrices=False)
    values = np.maximum(values, 1e-9 * values[0])
    inverse: Array = (rows.T / values**2) @ rows
    covariance: Array = variance * inverse / np.outer(scale, scale)
    return covariance
