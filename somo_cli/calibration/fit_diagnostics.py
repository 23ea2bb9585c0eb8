"""Reasons not to trust a fit."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from somo_cli.arrays import Array
from somo_cli.calibration.fit import FitResult

MAX_CORRELATION = 0.98  # above it the data do not distinguish two parameters
MAX_RELATIVE_ERROR = 0.2  # half width of a confidence interval, over the value
MAX_AUTOCORRELATION = 0.5
ROUNDING_RATIO = 1e-6  # residuals over the scatter of the data, below which they are rounding


def fit_diagnostics(found: FitResult, scatter: Array) -> Iterator[str]:
    """Yield one sentence for each reason not to trust the fit.

    `scatter` is the standard deviation of each measured column, shape (columns,).
    """
    for one in found.insensitive:
        yield f"the data do not depend on the {one.name}, which stays at {one.guess:.6g}"
    pairs = list(combinations(range(len(found.parameters)), 2))
    for first, second in pairs:
        correlation = found.correlation[first, second]
        if abs(correlation) > MAX_CORRELATION:
            names = [found.parameters[number].name for number in (first, second)]
            yield (
                f"the data do not distinguish the {names[0]} from the {names[1]}: "
                f"the correlation of their errors is {correlation:.4f}"
            )
    for number, one in enumerate(found.parameters):
        width = found.errors[number] / abs(found.values[number])
        if width > MAX_RELATIVE_ERROR:
            yield f"the {one.name} is uncertain by {100 * width:.2g} %"
    is_followed = bool((found.residual_rms <= ROUNDING_RATIO * scatter).all())
    if found.autocorrelation > MAX_AUTOCORRELATION and not is_followed:
        yield (
            "the residuals are not noise (correlation of neighbouring rows "
            f"{found.autocorrelation:.2f}): the scene does not follow the measurement, or its time "
            "step is too long, and the confidence intervals are too narrow"
        )
