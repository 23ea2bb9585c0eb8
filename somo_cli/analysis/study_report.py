"""A study as a table and in sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence

from somo_cli.analysis.choice import (
    RatedCase,
    balanced,
    cheapest,
    is_judged_by_recorded,
    most_accurate,
)
from somo_cli.analysis.errors import ErrorSummary
from somo_cli.analysis.recorded_report import outcome_remarks, recorded_remarks
from somo_cli.analysis.study_model import Discretization, Study, StudyCase
from somo_cli.analysis.text_table import table_lines

_HEADER = (
    "integrator", "step [s]", "tip max [m]", "of length", "final [m]", "rms [m]", "angles [rad]",
    "energy", "order", "time [ms]", "steps/s", "x real time",
)  # fmt: skip


def table(study: Study) -> str:
    """Return a row for each case; an error with a < is smaller than that of the reference."""
    has_segment_counts = any(one.segments is not None for one in study.discretizations)
    rows: list[Sequence[str]] = [("segments" if has_segment_counts else "joints", *_HEADER)]
    rows += [
        _cells(discretization, case)
        for discretization in study.discretizations
        for case in study.cases
        if case.segments == discretization.segments
    ]
    return "\n".join(table_lines(rows))


def _cells(discretization: Discretization, case: StudyCase) -> list[str]:
    count = discretization.joints if case.segments is None else case.segments
    start = [str(count), case.integrator, f"{case.time_step:g}"]
    if case.status != "ok":
        return [*start, case.status]
    least = discretization.reference.error
    final, tip, rms = final_max_rms(case.errors["tip_position"])
    speed = case.steps / case.run_time
    return [
        *start,
        _error(tip, least["tip_position"]),
        _error(
            None if tip is None else tip / discretization.length,
            least["tip_position"] / discretization.length,
        ),
        _error(final, least["tip_position"]),
        _error(rms, least["tip_position"]),
        _error(final_max_rms(case.errors["joint_angles"])[1], least["joint_angles"]),
        _relative_energy_error(case, discretization),
        "" if math.isnan(case.order) else f"{case.order:.2f}",
        f"{1e3 * case.run_time:.4g}",
        f"{speed:.0f}",
        f"{case.time_step * speed:.3g}",
    ]


def _relative_energy_error(case: StudyCase, discretization: Discretization) -> str:
    """Return the largest error of the energy, relative to the range of one form of energy."""
    if discretization.energy <= 0:
        return ""
    energy = final_max_rms(case.errors["energy"])[1]
    least = discretization.reference.error["energy"] / discretization.energy
    return _error(None if energy is None else energy / discretization.energy, least)


def _error(value: float | None, least: float) -> str:
    return f"<{least:.1e}" if value is None else f"{value:.2e}"


def remarks(study: Study, target: float) -> list[str]:
    """Return sentences on the references, the balanced cases and, last, the recommendation."""
    sentences = []
    for discretization in study.discretizations:
        reference = discretization.reference
        where = "" if discretization.segments is None else f"{discretization.segments} segments: "
        sentences.append(
            f"{where}reference: {reference.kind} (finest step {reference.time_step:g} s), "
            f"tip error {reference.error['tip_position']:.1e} m"
        )
        if study.model:
            error = _error(final_max_rms(discretization.model)[1], study.model_error)
            sentences.append(f"{where}model error against {study.model}: tip {error} m")
    for one in balanced(study):
        sentences.append(
            f"balanced: {_settings(one.case, one.discretization)}: solver {_percent(one.solver)}, "
            f"model {_percent(one.model or 0.0)}"
        )
    return [
        *sentences,
        *recorded_remarks(study),
        *outcome_remarks(study),
        recommendation(study, target),
    ]


def recommendation(study: Study, target: float) -> str:
    """Return the sentence that recommends a case for a target error.

    It is that of the tip relative to the length or, where a scene with contact or objects records
    columns, the worst error of those relative to their ranges.
    """
    best = cheapest(study, target)
    by_recorded = is_judged_by_recorded(study)
    goal = (
        f"{_percent(target)} error of all that is recorded"
        if by_recorded
        else (f"{_percent(target)} tip error")
    )
    if best is not None:
        worst = _worst(best) if by_recorded else ""
        return f"for {goal} use {_settings(best.case, best.discretization)}: {_speed(best)}{worst}"
    close = most_accurate(study)
    if close is None:
        return f"no case completed, so none has {goal}: try smaller steps"
    return (
        f"no case has {goal}: the best is {_settings(close.case, close.discretization)} with "
        f"{_percent(close.larger_error)}{_worst(close) if by_recorded else ''}"
    )


def _worst(one: RatedCase) -> str:
    """Return the name of the column with the worst error of a case."""
    found = max(
        (found for found in (one.case.recorded, one.discretization.recorded) if found is not None),
        key=lambda found: found.relative,
    )
    return "" if found.worst is None else f" (worst: {found.worst.name})"


def _settings(case: StudyCase, discretization: Discretization) -> str:
    count = "" if case.segments is None else f"{case.segments} segments, "
    return f"{count}{case.integrator}, dt = {case.time_step:g} s"


def _speed(one: RatedCase) -> str:
    factor = one.case.steps * one.case.time_step / one.case.run_time
    return f"{float(f'{factor:.2g}'):g}x real time"


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def final_max_rms(error: ErrorSummary | None) -> tuple[float | None, ...]:
    """Return the three numbers of a summary, or None for each."""
    return (None, None, None) if error is None else (error.final, error.maximum, error.rms)
