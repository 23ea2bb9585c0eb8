"""A study as CSV and as values for JSON."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence

from somo_cli.analysis.choice import balanced, cheapest, is_judged_by_recorded
from somo_cli.analysis.error_report import plain_columns
from somo_cli.analysis.errors import UNITS, ErrorSummary
from somo_cli.analysis.recorded_errors import RecordedErrors
from somo_cli.analysis.study_model import Discretization, Study, StudyCase
from somo_cli.analysis.study_report import final_max_rms, recommendation
from somo_cli.scene.model import Quantity


def csv_text(study: Study) -> str:
    """Return a header and a row for each case as CSV; unknown cells are empty."""
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
        *_recorded_names(study),
    ]  # fmt: skip
    by_segments = {one.segments: one for one in study.discretizations}
    for case in study.cases:
        discretization = by_segments[case.segments]
        yield [_empty_if_unknown(cell) for cell in _csv_cells(case, discretization, quantities)]


def _csv_cells(
    case: StudyCase, discretization: Discretization, quantities: Sequence[Quantity]
) -> Iterator[object]:
    speed = case.steps / case.run_time if case.status == "ok" else math.nan
    tip = final_max_rms(case.errors.get("tip_position"))[1]
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
    yield final_max_rms(discretization.model)[1]
    for quantity in quantities:
        yield from final_max_rms(case.errors.get(quantity))
        yield discretization.reference.error[quantity]
    yield from _recorded_cells(case, discretization)


def _recorded_names(study: Study) -> Iterator[str]:
    """Yield the names of the columns on contact and objects; none without these."""
    found = study.discretizations[0].recorded
    if found is None:
        return
    yield from ("contact_events", "worst_column", "worst_relative")
    yield from (f"{one}-{other}_mean_normal_n" for one, other in found.forces)


def _recorded_cells(case: StudyCase, discretization: Discretization) -> Iterator[object]:
    if discretization.recorded is None:
        return
    if case.recorded is None:
        yield from [None] * (3 + len(discretization.recorded.forces))
        return
    worst = case.recorded.worst
    yield case.recorded.events
    yield None if worst is None else worst.name
    yield None if worst is None else worst.relative
    yield from case.recorded.forces.values()


def _empty_if_unknown(cell: object) -> object:
    is_unknown = cell is None or (isinstance(cell, float) and math.isnan(cell))
    return "" if is_unknown else cell


def _unit_suffix(unit: str) -> str:
    words = {"1": "", "1/m": "per_m", "rad/s": "rad_per_s", "N·m": "nm", "J": "j"}
    return words.get(unit, unit)


def _quantities(study: Study) -> list[Quantity]:
    return list(study.discretizations[0].reference.error)


def plain_data(study: Study, target: float) -> dict[str, object]:
    """Return the whole study as values for JSON, in SI."""
    best = cheapest(study, target)
    return {
        "choice": recommendation(study, target),
        "target_relative_tip_error": target,
        "is_judged_by_recorded": is_judged_by_recorded(study),
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
        **_recorded_as_json(discretization.recorded),
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
        **_recorded_as_json(case.recorded),
    }


def _recorded_as_json(found: RecordedErrors | None) -> dict[str, object]:
    """Return the worst column of each kind, mean normal forces and events, if there are any."""
    if found is None:
        return {}
    return {
        "recorded": {
            "contact_events": found.events,
            "mean_normal_force_n": {
                f"{one}-{other}": n for (one, other), n in found.forces.items()
            },
            "worst": None if found.worst is None else found.worst.name,
            "worst_relative": found.relative,
            "columns": plain_columns(found.by_family),
        }
    }


def _error_as_json(error: ErrorSummary) -> dict[str, object]:
    return {"final": error.final, "max": error.maximum, "rms": error.rms}


def _none_if_nan(value: float) -> float | None:
    return None if math.isnan(value) else value
