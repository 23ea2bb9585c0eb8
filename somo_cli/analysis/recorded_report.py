"""Contact and objects of a study as a table: events, poses, forces, and the worst column."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.analysis.outcomes import outcomes
from somo_cli.analysis.recorded_errors import RecordedErrors
from somo_cli.analysis.study_model import Discretization, Study, StudyCase
from somo_cli.analysis.text_table import table_lines
from somo_cli.analysis.verdict import described, percent

MOST_OBJECTS = 3
MOST_PAIRS = 5
"""Columns of a table that is still read; `report.csv` has all."""


def recorded_table(study: Study) -> str:
    """Return a row for each case and reference of a study, or nothing without contact or objects.

    A pair has its mean normal force, so that rows can be compared; objects have their errors.
    """
    found = [one.recorded for one in study.discretizations if one.recorded is not None]
    if not found:
        return ""
    objects = [one.name for one in study.scene.objects][:MOST_OBJECTS]
    pairs = _pressing_pairs(found)
    counts = "segments" if study.discretizations[0].segments is not None else "joints"
    rows: list[Sequence[str]] = [
        (
            counts,
            "integrator",
            "step [s]",
            "events",
            *(head for name in objects for head in (f"{name} [m]", f"{name} [rad]")),
            *(f"{one}-{other} [N]" for one, other in pairs),
            "worst, of its range",
            "column",
        )
    ]
    for discretization in study.discretizations:
        count = str(
            discretization.joints if discretization.segments is None else discretization.segments
        )
        for case in study.cases:
            if case.segments == discretization.segments:
                rows.append(_case_cells(count, case, objects, pairs))
        rows.append(_reference_cells(count, discretization, objects, pairs))
    return "\n".join(table_lines(rows))


def recorded_remarks(study: Study) -> list[str]:
    """Return how far the reference is known, by the worst of what the scene records."""
    sentences = []
    for discretization in study.discretizations:
        found = discretization.recorded
        if found is None or found.worst is None:
            continue
        where = "" if discretization.segments is None else f"{discretization.segments} segments: "
        sentences.append(
            f"{where}of what the scene records, the reference knows {found.worst.name} least: "
            f"to {described(found.worst)}"
        )
    return sentences


def outcome_remarks(study: Study) -> list[str]:
    """Return the outcomes of each integrator whose runs part ways, the reference among them."""
    sentences = []
    for discretization in study.discretizations:
        finest = discretization.recorded
        if finest is None:
            continue
        where = "" if discretization.segments is None else f"{discretization.segments} segments, "
        for integrator in study.settings.integrators:
            runs = [
                (case.time_step, case.recorded.ends)
                for case in study.cases
                if case.recorded is not None
                and (case.segments, case.integrator) == (discretization.segments, integrator)
            ]
            runs.append((discretization.reference.time_step, finest.ends))
            steps, ends = zip(*runs, strict=True)
            found = outcomes(finest.columns, steps, np.array(ends))
            if found is not None:
                sentences.append(f"{where}{integrator}: {found.sentence}")
    return sentences


def _pressing_pairs(found: Sequence[RecordedErrors]) -> list[tuple[str, str]]:
    """Return the pairs that press on each other, with the largest mean forces, in their order."""
    forces = {pair: max(one.forces[pair] for one in found) for pair in found[0].forces}
    largest = sorted((pair for pair in forces if forces[pair] > 0), key=lambda one: -forces[one])
    return [pair for pair in forces if pair in largest[:MOST_PAIRS]]


def _case_cells(
    count: str, case: StudyCase, objects: Sequence[str], pairs: Sequence[tuple[str, str]]
) -> list[str]:
    start = [count, case.integrator, f"{case.time_step:g}"]
    if case.recorded is None:
        return [*start, case.status]
    return [*start, *_cells(case.recorded, objects, pairs)]


def _reference_cells(
    count: str,
    discretization: Discretization,
    objects: Sequence[str],
    pairs: Sequence[tuple[str, str]],
) -> list[str]:
    assert discretization.recorded is not None, "all of a scene have contact or none"
    step = f"{discretization.reference.time_step:g}"
    return [count, "reference", step, *_cells(discretization.recorded, objects, pairs)]


def _cells(
    found: RecordedErrors, objects: Sequence[str], pairs: Sequence[tuple[str, str]]
) -> list[str]:
    poses = (
        f"{size:.1e}"
        for name in objects
        for size in (found.of_object(name, "m"), 2 * found.of_object(name, "1"))
    )
    worst = found.worst
    told = ["", ""] if worst is None else [percent(worst.relative), worst.name]
    return [str(found.events), *poses, *(f"{found.forces[pair]:.4g}" for pair in pairs), *told]
