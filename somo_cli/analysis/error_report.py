"""The estimated error of a run, as lines of text and as values for JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence

from somo_cli.analysis.error_estimate import ColumnError, ErrorEstimate
from somo_cli.analysis.outcomes import outcomes
from somo_cli.analysis.text_table import table_lines
from somo_cli.analysis.verdict import (
    CONVERGED,
    WORST_COUNT,
    is_converged,
    percent,
    verdict,
    worst,
)

HEADER = ("worst columns", "error", "unit", "of its range", "judged by", "order")
JUDGED_BY = {"largest": "largest error", "mean": "mean error", "impulse": "impulse"}


def estimate_lines(estimate: ErrorEstimate) -> list[str]:
    """Return the columns with the largest errors, and the verdict, as lines."""
    runs = " and ".join(f"{step:g}" for step in estimate.others)
    return [
        f"estimated error, by the same scene at {runs} s ({estimate.run_time:.3g} s more):",
        *(f"  {line}" for line in worst_lines(estimate.errors)),
        verdict(estimate.time_step, estimate.errors, _parted(estimate)),
    ]


def worst_lines(errors: Sequence[ColumnError], count: int = WORST_COUNT) -> list[str]:
    """Return a table of the columns with the largest errors relative to their scales."""
    rows: list[Sequence[str]] = [HEADER]
    for one in worst(errors, count):
        order = one.order.value
        rows.append(
            (
                one.name,
                f"{one.judged:.1e}",
                one.unit,
                percent(one.relative),
                JUDGED_BY[one.measure],
                "-" if math.isnan(order) else f"{order:.1f}",
            )
        )
    return table_lines(rows)


def plain_estimate(estimate: ErrorEstimate) -> dict[str, object]:
    """Return the verdict and the estimated error of every column as values for JSON."""
    return {
        "method": "the same scene at other steps, extrapolated with the order that they show",
        "compared_time_steps_s": list(estimate.others),
        "order": estimate.order,
        "run_time_s": estimate.run_time,
        **plain_verdict(estimate),
        "columns": plain_columns(estimate.errors),
    }


def plain_verdict(estimate: ErrorEstimate) -> dict[str, object]:
    """Return the verdict on a run as values for JSON."""
    found = outcomes(estimate.errors, estimate.levels, estimate.ends)
    return {
        "verdict": verdict(estimate.time_step, estimate.errors, _parted(estimate)),
        "is_converged": is_converged(estimate.errors),
        "target_relative": CONVERGED,
        "outcomes": None if found is None else found.plain_data(),
        "worst": [
            {"column": one.name, "relative": one.relative}
            for one in worst(estimate.errors, WORST_COUNT)
        ],
    }


def _parted(estimate: ErrorEstimate) -> str:
    """Return the sentence on two outcomes, empty if the runs draw together."""
    found = outcomes(estimate.errors, estimate.levels, estimate.ends)
    return "" if found is None else found.sentence


def plain_columns(errors: Sequence[ColumnError]) -> dict[str, object]:
    """Return the estimated error of every column, by its name, as values for JSON."""
    return {
        one.name: {
            "final": one.final,
            "max": one.maximum,
            "rms": one.rms,
            "judged_by": one.measure,
            "judged": one.judged,
            "scale": one.scale,
            "relative": one.relative,
            "order": None if math.isnan(one.order.value) else one.order.value,
        }
        for one in errors
    }
