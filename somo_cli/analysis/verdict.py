"""Whether a run is converged, in one line, and the columns that say so."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.analysis.error_estimate import ColumnError
from somo_cli.analysis.round_steps import round_down_step

CONVERGED = 0.01  # largest error, relative to the scale of the column
WORST_COUNT = 5
SMALLEST_FACTOR = 64  # of a step that is recommended


def worst(errors: Sequence[ColumnError], count: int = WORST_COUNT) -> list[ColumnError]:
    """Return the columns with the largest errors relative to their scales, the worst first."""
    return sorted(errors, key=lambda one: one.relative, reverse=True)[:count]


def is_converged(errors: Sequence[ColumnError], target: float = CONVERGED) -> bool:
    """Whether there are errors, and each is at most `target`, relative to its scale."""
    return bool(errors) and all(one.relative <= target for one in errors)


def verdict(
    time_step: float,
    errors: Sequence[ColumnError],
    parted: str = "",
    target: float = CONVERGED,
) -> str:
    """Return one line on a run at a time step [s].

    `parted` names the outcomes if runs at other steps ended elsewhere.
    """
    if not errors:
        return "NOT judged: only the start is recorded; try more --steps or a smaller --every"
    first = worst(errors, 1)[0]
    if first.relative <= target:
        line = f"converged to {percent(first.relative)}"
        return f"{line}, but {parted}" if parted else line
    line = f"NOT converged: {first.name} differs by {described(first)}"
    if parted:
        return f"{line}; {parted}; look with --tolerance whether smaller steps agree"
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
