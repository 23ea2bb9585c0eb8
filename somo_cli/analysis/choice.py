"""Recommended cases of a study: the cheapest one within a target error, and balanced ones."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.analysis.study_model import Discretization, Study, StudyCase


@dataclass(frozen=True, slots=True)
class RatedCase:
    """A case and its errors: of the solver, and of the chain model at the tip over the length.

    `tip` is the solver's error of the tip over the length. `solver` is the same, but where a scene
    with contact or objects records columns the largest error of those over their ranges: a tip
    within 1 % says nothing of an object that was dropped.
    """

    case: StudyCase
    discretization: Discretization
    solver: float
    model: float | None
    tip: float

    @property
    def larger_error(self) -> float:
        """The larger of the two errors; their signs are unknown, so they are not added."""
        return max(self.solver, self.model or 0.0)


def rated_cases(study: Study) -> tuple[RatedCase, ...]:
    """Return every case that completed, with its errors, the cheapest first."""
    discretizations = {
        discretization.segments: discretization for discretization in study.discretizations
    }
    found = []
    for case in study.cases:
        if case.status != "ok":
            continue
        discretization = discretizations[case.segments]
        model = None
        if study.model:
            known = discretization.model
            model = (study.model_error if known is None else known.maximum) / discretization.length
        error = case.errors["tip_position"]
        least = discretization.reference.error["tip_position"]
        tip = (least if error is None else error.maximum) / discretization.length
        solver = _recorded_error(case, discretization)
        found.append(RatedCase(case, discretization, tip if solver is None else solver, model, tip))
    return tuple(sorted(found, key=lambda one: one.case.run_time))


def _recorded_error(case: StudyCase, discretization: Discretization) -> float | None:
    """Return the worst error of what the scene records; not below that of the reference."""
    own, reference = case.recorded, discretization.recorded
    if own is None or reference is None or own.worst is None:
        return None
    return max(own.relative, reference.relative)


def is_judged_by_recorded(study: Study) -> bool:
    """Whether cases are judged by all that the scene records, and not by the tip alone."""
    return any(
        _recorded_error(one.case, one.discretization) is not None for one in rated_cases(study)
    )


def cheapest(study: Study, target: float) -> RatedCase | None:
    """Return the fastest case whose errors are both at most `target`, relative to the length."""
    return next((one for one in rated_cases(study) if one.larger_error <= target), None)


def most_accurate(study: Study) -> RatedCase | None:
    """Return the case whose larger error is smallest."""
    return min(rated_cases(study), key=lambda one: one.larger_error, default=None)


def balanced(study: Study) -> tuple[RatedCase, ...]:
    """Return, for each number of segments, the cheapest case with less solver than model error.

    Shorter steps would not reduce the total error, and longer ones would not need as many joints.
    """
    found: dict[int | None, RatedCase] = {}
    for one in rated_cases(study):
        if one.model is not None and one.solver <= one.model:
            found.setdefault(one.case.segments, one)
    return tuple(
        found[discretization.segments]
        for discretization in study.discretizations
        if discretization.segments in found
    )
