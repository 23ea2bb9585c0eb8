"""How far chains of links are from the continuum that they stand for."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from somo_cli.analysis.beam_reference import CONTINUUM, beam_tip
from somo_cli.analysis.errors import ErrorSummary, error_profiles, summarize_errors
from somo_cli.analysis.reference import extrapolate
from somo_cli.analysis.study_model import Study
from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan


def with_model_errors(study: Study, scenes: Sequence[Scene]) -> Study:
    """Return the study with the tip error of each chain against the continuum [m], where known.

    The continuum is the closed form of a beam that the scene names, else the limit of many
    segments, for which the three largest numbers of segments must be in one ratio. `scenes` are
    those of the discretizations. An error below that of the continuum itself becomes None.
    """
    models: list[ErrorSummary]
    if study.scene.reference in CONTINUUM:
        name = str(study.scene.reference)
        beams = [
            beam_tip(scene, one.reference)
            for scene, one in zip(scenes, study.discretizations, strict=True)
        ]
        models = [ErrorSummary(one.distance, one.distance, one.distance) for one in beams]
        error = max(one.error for one in beams)
    else:
        name = "the limit of many segments"
        limit = _errors_against_segment_limit(study, scenes)
        if limit is None:
            return study
        models, error = limit
    discretizations = tuple(
        dataclasses.replace(one, model=model if model.maximum > error else None)
        for one, model in zip(study.discretizations, models, strict=True)
    )
    return dataclasses.replace(
        study, discretizations=discretizations, model=name, model_error=error
    )


def _errors_against_segment_limit(
    study: Study, scenes: Sequence[Scene]
) -> tuple[list[ErrorSummary], float] | None:
    """Return the tip error of each chain against the limit of many segments, and its error [m]."""
    counted = sorted(
        (one.segments, index)
        for index, one in enumerate(study.discretizations)
        if one.segments is not None
    )
    if len(counted) < 3:
        return None
    (n1, _), (n2, _), (n3, finest) = counted[-3:]
    if n2 * n2 != n1 * n3:
        return None
    plan = make_plan(dataclasses.replace(scenes[finest], columns=("tip_position",)))
    rows = [
        _tips(scene, one.reference.rows)
        for scene, one in zip(scenes, study.discretizations, strict=True)
    ]
    limit = extrapolate(plan, [rows[index] for _, index in counted[-3:]], n3 / n2)
    models = [
        summarize_errors(error_profiles(plan, one, limit.rows)["tip_position"]) for one in rows
    ]
    return models, limit.error["tip_position"]


def _tips(scene: Scene, rows: Array) -> Array:
    """Return time and tip positions alone, in the order of the bodies."""
    parts = [
        rows[:, group.first : group.last]
        for group in columns.body_column_groups(make_plan(scene).recorded)
        if group.quantity == "tip_position"
    ]
    return np.hstack([rows[:, :1], *parts])
