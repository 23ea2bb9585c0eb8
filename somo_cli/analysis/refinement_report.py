"""What the halvings of a step cost and brought, as lines of text and as values for JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence

from somo_cli.analysis.error_report import plain_columns, worst_lines
from somo_cli.analysis.refinement import LevelReport, Refinement
from somo_cli.analysis.text_table import table_lines
from somo_cli.analysis.verdict import described, percent, quantity, worst
from somo_cli.problems import counted

HEADER = ("step [s]", "run time [s]", "worst error", "of its range", "of the tolerance", "column")


def refinement_lines(found: Refinement) -> list[str]:
    """Return what each run cost, the worst columns if not all are within, and the verdict."""
    rows: list[Sequence[str]] = [HEADER, *map(_cells, found.levels)]
    lines = [f"  {line}" for line in table_lines(rows)]
    if not found.is_converged and found.errors:
        lines += [f"  {line}" for line in worst_lines(found.errors)]
    return [*lines, verdict(found)]


def _cells(level: LevelReport) -> list[str]:
    start = [f"{level.time_step:g}", f"{level.run_time:.3g}"]
    if level.status != "ok":
        return [*start, level.status]
    if level.worst is None:
        return start
    size = quantity(level.worst.judged, level.worst.unit)
    return [
        *start,
        size,
        percent(level.worst.relative),
        percent(level.excess),
        level.worst.name,
    ]


def verdict(found: Refinement) -> str:
    """Return one line: converged to what, or which columns are not."""
    halved = f"{counted(found.halvings, 'halving')} of the step, at {found.plan.time_step:g} s"
    if not found.errors:
        return f"NOT judged after {halved}: there are no two runs with rows beside the start"
    judge = found.tolerances.excess
    first = max(found.errors, key=judge)
    parted = "" if found.outcomes is None else found.outcomes.sentence
    size = percent(worst(found.errors, 1)[0].relative)
    if found.is_converged:
        return f"converged to {size} after {halved}" + (f", but {parted}" if parted else "")
    if found.agrees:
        return (
            f"NOT converged after {halved}: the last two runs agree to {size}, but the one before "
            f"did not: {parted}; one more of --halvings tells whether smaller steps agree"
        )
    missing = [one for one in found.errors if judge(one) > 1]
    more = "" if len(missing) == 1 else f", and {counted(len(missing) - 1, 'more column')}"
    line = f"NOT converged after {halved}: {first.name} differs by {described(first)}{more}"
    if parted:
        line += f"; {parted}"
    return f"{line}; what is written is the finest run"


def plain_refinement(found: Refinement) -> dict[str, object]:
    """Return what was asked, what each run cost and what came out, as values for JSON."""
    return {
        "tolerance": found.tolerances.plain_data(),
        "halvings": found.halvings,
        "run_time_s": found.run_time,
        "levels": [
            {
                "time_step_s": level.time_step,
                "run_time_s": level.run_time,
                "status": level.status,
                "worst_column": None if level.worst is None else level.worst.name,
                "worst_error": None if level.worst is None else level.worst.judged,
                "error_over_tolerance": None if math.isnan(level.excess) else level.excess,
            }
            for level in found.levels
        ],
    }


def plain_error(found: Refinement) -> dict[str, object]:
    """Return the verdict and the error of every column of the finest run as values for JSON."""
    return {
        "method": "the step halved until the runs agree",
        "verdict": verdict(found),
        "is_converged": found.is_converged,
        "outcomes": None if found.outcomes is None else found.outcomes.plain_data(),
        "worst": [{"column": one.name, "relative": one.relative} for one in worst(found.errors)],
        "columns": plain_columns(found.errors),
    }
