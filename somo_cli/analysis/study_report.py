"""A study in words, as a table, and as plain values."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence

from somo_cli.analysis.choice import RatedCase, balanced, cheapest, most_accurate
from somo_cli.analysis.errors import UNITS, ErrorSummary
from somo_cli.analysis.study_model import Discretization, Study, StudyCase
from somo_cli.analysis.text_table import table_lines
from somo_cli.scene.model import Quantity

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
    final, tip, rms = _final_max_rms(case.errors["tip_position"])
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
        _error(_final_max_rms(case.errors["joint_angles"])[1], least["joint_angles"]),
        _relative_energy_error(case, discretization),
        "" if math.isnan(case.order) else f"{case.order:.2f}",
        f"{1e3 * case.run_time:.4g}",
        f"{speed:.0f}",
        f"{case.time_step * speed:.3g}",
    ]


def _relative_energy_error(case: StudyCase, discretization: Discretization) -> str:
    """Return the largest error of the energy, relative to the most that one form of it varied."""
    if discretization.energy <= 0:
        return ""
    energy = _final_max_rms(case.errors["energy"])[1]
    least = discretization.reference.error["energy"] / discretization.energy
    return _error(None if energy is None else energy / discretization.energy, least)


def _error(value: float | None, least: float) -> str:
    return f"<{least:.1e}" if value is None else f"{value:.2e}"


def remarks(study: Study, target: float) -> list[str]:
    """Return what to know besides the table, the choice last, a sentence each."""
    sentences = []
    for discretization in study.discretizations:
        reference = discretization.reference
        where = "" if discretization.segments is None else f"{discretization.segments} segments: "
        sentences.append(
            f"{where}reference: {reference.kind} (finest step {reference.time_step:g} s), "
            f"tip known to {reference.error['tip_position']:.1e} m"
        )
        if study.model:
            told = _error(_final_max_rms(discretization.model)[1], study.model_error)
            sentences.append(f"{where}model error against {study.model}: tip {told} m")
    for one in balanced(study):
        sentences.append(
            f"balanced: {_settings(one.case, one.discretization)}: solver {_percent(one.solver)}, "
            f"model {_percent(one.model or 0.0)}"
        )
    sentences.append(recommendation(study, target))
    return sentences


def recommendation(study: Study, target: float) -> str:
    """Return the sentence that says what to choose."""
    best = cheapest(study, target)
    goal = f"{_percent(target)} tip error"
    if best is not None:
        return f"for {goal} use {_settings(best.case, best.discretization)}: {_speed(best)}"
    close = most_accurate(study)
    if close is None:
        return f"no case ran to its end, so none has {goal}: try smaller steps"
    return (
        f"no case has {goal}: the nearest is {_settings(close.case, close.discretization)} with "
        f"{_percent(close.larger_error)}"
    )


def _settings(case: StudyCase, discretization: Discretization) -> str:
    count = "" if case.segments is None else f"{case.segments} segments, "
    return f"{count}{case.integrator}, dt = {case.time_step:g} s"


def _speed(one: RatedCase) -> str:
    factor = one.case.steps * one.case.time_step / one.case.run_time
    return f"{float(f'{factor:.2g}'):g}x real time"


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def csv_text(study: Study) -> str:
    """Return a header and a row for each case as CSV; cells are empty where nothing is known."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(_csv_rows(study))
    return stream.getvalue()


def _csv_rows(study: Study) -> Iterator[Sequence[object]]:
    quantities = _quantities(study)
    names = [
        f"{quantity}_{kind}_{_unit_suffix(UNITS[quantity])}"
        for quantity in quantities
        for kind in ("final", "max", "rms", "reference_error")
    ]
    yield [
        "segments", "joints", "integrator", "time_step_s", "steps", "status", "run_time_s",
        "steps_per_second", "real_time_factor", "order", "tip_max_relative", "model_error_m",
        *names,
    ]  # fmt: skip
    cuts = {discretization.segments: discretization for discretization in study.discretizations}
    for case in study.cases:
        discretization = cuts[case.segments]
        yield [_empty_if_unknown(cell) for cell in _csv_cells(case, discretization, quantities)]


def _csv_cells(
    case: StudyCase, discretization: Discretization, quantities: Sequence[Quantity]
) -> Iterator[object]:
    speed = case.steps / case.run_time if case.status == "ok" else math.nan
    tip = _final_max_rms(case.errors.get("tip_position"))[1]
    yield from (
        case.segments,
        discretization.joints,
        case.integrator,
        case.time_step,
        case.steps,
        case.status,
    )
    yield from (case.run_time, speed, case.time_step * speed, case.order)
    yield None if tip is None else tip / discretization.length
    yield _final_max_rms(discretization.model)[1]
    for quantity in quantities:
        yield from _final_max_rms(case.errors.get(quantity))
        yield discretization.reference.error[quantity]


def _final_max_rms(error: ErrorSummary | None) -> tuple[float | None, ...]:
    return (None, None, None) if error is None else (error.final, error.maximum, error.rms)


def _empty_if_unknown(cell: object) -> object:
    is_nothing = cell is None or (isinstance(cell, float) and math.isnan(cell))
    return "" if is_nothing else cell


def _unit_suffix(unit: str) -> str:
    words = {"1": "", "1/m": "per_m", "rad/s": "rad_per_s", "N·m": "nm", "J": "j"}
    return words.get(unit, unit)


def _quantities(study: Study) -> list[Quantity]:
    return list(study.discretizations[0].reference.error)


def plain_data(study: Study, target: float) -> dict[str, object]:
    """Return the whole study as values for JSON."""
    best = cheapest(study, target)
    return {
        "choice": recommendation(study, target),
        "target_relative_tip_error": target,
        "chosen": None if best is None else _settings_as_json(best.case),
        "balanced": [
            {
                **_settings_as_json(one.case),
                "solver_relative": one.solver,
                "model_relative": one.model,
            }
            for one in balanced(study)
        ],
        "duration_s": study.settings.instants.duration,
        "interval_s": float(study.settings.instants.interval),
        "repeats": study.settings.repeats,
        "model": study.model or None,
        "model_reference_error_m": _none_if_nan(study.model_error),
        "cuts": [
            _discretization_as_json(discretization) for discretization in study.discretizations
        ],
        "cases": [_case_as_json(case) for case in study.cases],
    }


def _settings_as_json(case: StudyCase) -> dict[str, object]:
    return {
        "segments": case.segments,
        "integrator": case.integrator,
        "time_step_s": case.time_step,
    }


def _discretization_as_json(discretization: Discretization) -> dict[str, object]:
    reference = discretization.reference
    return {
        "segments": discretization.segments,
        "joints": discretization.joints,
        "length_m": discretization.length,
        "energy_exchanged_j": discretization.energy,
        "reference": reference.kind,
        "reference_time_step_s": reference.time_step,
        "reference_error": dict(reference.error),
        "reference_order": {key: _none_if_nan(value) for key, value in reference.order.items()},
        "model_error_m": None
        if discretization.model is None
        else _error_as_json(discretization.model),
    }


def _case_as_json(case: StudyCase) -> dict[str, object]:
    return {
        **_settings_as_json(case),
        "steps": case.steps,
        "status": case.status,
        "reason": case.reason or None,
        "run_time_s": _none_if_nan(case.run_time),
        "order": _none_if_nan(case.order),
        "errors": {
            quantity: None if error is None else {"unit": UNITS[quantity], **_error_as_json(error)}
            for quantity, error in case.errors.items()
        },
    }


def _error_as_json(error: ErrorSummary) -> dict[str, object]:
    return {"final": error.final, "max": error.maximum, "rms": error.rms}


def _none_if_nan(value: float) -> float | None:
    return None if math.isnan(value) else value
