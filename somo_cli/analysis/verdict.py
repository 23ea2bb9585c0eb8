"""Whether a run is converged, in one line, and the columns that say so."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.analysis.error_estimate import ColumnError
from somo_cli.analysis.round_steps import round_down_step

CONVERGED = 0.01  # largest error, relative to the scale of the column
WORST_COUNT = 5
TWO_OUTCOMES = 0.25  # of the scale: what ends so far from where it does at half the step
SMALLEST_FACTOR = 64  # of a step that is recommended


def worst(errors: Sequence[ColumnError], count: int = WORST_COUNT) -> list[ColumnError]:
    """Return the columns with the largest errors relative to their scales, the worst first."""
    return sorted(errors, key=lambda one: one.relative, reverse=True)[:count]


def is_converged(errors: Sequence[ColumnError], target: float = CONVERGED) -> bool:
    """Whether there are errors, and each is at most `target`, relative to its scale."""
    return bool(errors) and all(one.relative <= target for one in errors)


def has_two_outcomes(error: ColumnError) -> bool:
    """Whether a column ends elsewhere at half the step, and the runs do not draw together.

    Then the scene is at a parting of ways, such as a grasp that slips or holds.
    """
    is_apart = abs(error.ends[0] - error.ends[1]) >= TWO_OUTCOMES * error.scale
    falls = not (error.order.is_irregular or error.order.is_growing)
    return error.measure == "largest" and is_apart and not falls


def verdict(time_step: float, errors: Sequence[ColumnError], target: float = CONVERGED) -> str:
    """Return one line on a run at a time step [s]."""
    if not errors:
        return "NOT judged: only the start is recorded; try more --steps or a smaller --every"
    first = worst(errors, 1)[0]
    if first.relative <= target:
        return f"converged to {percent(first.relative)}"
    line = f"NOT converged: {first.name} differs by {described(first)}"
    parted = next((one for one in worst(errors, len(errors)) if has_two_outcomes(one)), None)
    if parted is not None:
        ends = " and ".join(quantity(value, parted.unit) for value in parted.ends)
        return (
            f"{line}; two outcomes: {parted.name} ends at {ends} at {time_step:g} and "
            f"{time_step / 2:g} s; look with --tolerance whether smaller steps agree"
        )
    return f"{line}; try --time-step {better_step(time_step, errors, target):g}"


def better_step(time_step: float, errors: Sequence[ColumnError], target: float) -> float:
    """Return the step [s] at which all errors are expected to be below the target.

    It is 1, 2 or 5 times a power of ten, below the present step and not below 1/64 of it.
    """
    factors = [
        (target / one.relative) ** (1 / one.order.expected)
        for one in errors
        if one.relative > target
    ]
    factor = max(min([0.999, *factors]), 1 / SMALLEST_FACTOR)
    return round_down_step(factor * time_step)


def described(error: ColumnError) -> str:
    """Return an error with its unit, what it means, and its share of the scale."""
    meaning = {"largest": "", "mean": " on average", "impulse": " by its impulse"}[error.measure]
    size = quantity(error.judged, error.unit)
    return f"{size}{meaning} ({percent(error.relative)} of its range)"


def percent(share: float) -> str:
    """Return a share as text, such as "0.31 %"."""
    return f"{float(f'{100 * share:.2g}'):g} %"


def quantity(value: float, unit: str) -> str:
    """Return a value with its unit, lengths in millimetres."""
    if unit == "m":
        value, unit = 1e3 * value, "mm"
    return f"{value:.3g}" + ("" if unit == "1" else f" {unit}")
