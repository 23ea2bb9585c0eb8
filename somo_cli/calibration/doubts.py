"""What a person should know before trusting a fit."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from somo_cli.arrays import Array
from somo_cli.calibration.fit import Fit

TOGETHER = 0.98  # correlation from which on two parameters cannot be told apart
WIDE = 0.2  # of a value: what its error may be
PERSISTENT = 0.5
FOLLOWED = 1e-6  # of the scatter of the data: what is left over is rounding


def doubts(found: Fit, scatter: Array) -> Iterator[str]:
    """Yield one sentence for each reason not to trust the fit as it is.

    `scatter` is the standard deviation of every measured column, shape (columns,).
    """
    for one in found.silent:
        yield f"the data say nothing about the {one.name}: it stays at {one.guess:.6g}"
    pairs = list(combinations(range(len(found.parameters)), 2))
    for first, second in pairs:
        correlation = found.correlation[first, second]
        if abs(correlation) > TOGETHER:
            names = [found.parameters[number].name for number in (first, second)]
            yield (
                f"the data cannot tell the {names[0]} from the {names[1]}: "
                f"their errors go together, correlation {correlation:.4f}"
            )
    for number, one in enumerate(found.parameters):
        width = found.errors[number] / abs(found.values[number])
        if width > WIDE:
            yield f"the {one.name} is known to {100 * width:.2g} % only"
    is_followed = bool((found.left_over <= FOLLOWED * scatter).all())
    if found.persistence > PERSISTENT and not is_followed:
        yield (
            "what is left over is no noise (correlation of neighbouring rows "
            f"{found.persistence:.2f}): the scene, or its time step, does not follow what was "
            "measured, and the intervals are too narrow"
        )
