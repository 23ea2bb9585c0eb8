"""What a person should know before trusting a fit."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from somo_cli.arrays import Array
from somo_cli.calibration.fit import FitResult

MAX_CORRELATION = 0.98  # correlation from which on two parameters cannot be told apart
MAX_RELATIVE_ERROR = 0.2  # of a value: what its error may be
MAX_AUTOCORRELATION = 0.5
ROUNDING_RATIO = 1e-6  # of the scatter of the data: what is left over is rounding


def fit_diagnostics(found: FitResult, scatter: Array) -> Iterator[str]:
    """Yield one sentence for each reason not to trust the fit as it is.

    `scatter` is the standard deviation of every measured column, shape (columns,).
    """
    for one in found.insensitive:
        yield f"the data say nothing about the {one.name}: it stays at {one.guess:.6g}"
    pairs = list(combinations(range(len(found.parameters)), 2))
    for first, second in pairs:
        correlation = found.correlation[first, second]
        if abs(correlation) > MAX_CORRELATION:
            names = [found.parameters[number].name for number in (first, second)]
            yield (
                f"the data cannot tell the {names[0]} from the {names[1]}: "
                f"their errors go together, correlation {correlation:.4f}"
            )
    for number, one in enumerate(found.parameters):
        width = found.errors[number] / abs(found.values[number])
        if width > MAX_RELATIVE_ERROR:
            yield f"the {one.name} is known to {100 * width:.2g} % only"
    is_followed = bool((found.residual_rms <= ROUNDING_RATIO * scatter).all())
    if found.autocorrelation > MAX_AUTOCORRELATION and not is_followed:
        yield (
            "what is left over is no noise (correlation of neighbouring rows "
            f"{found.autocorrelation:.2f}): the scene, or its time step, does not follow what was "
            "measured, and the intervals are too narrow"
        )
