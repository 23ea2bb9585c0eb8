"""Recommended cases of a study: the cheapest one within a target error, and balanced ones."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.analysis.study_model import Discretization, Study, StudyCase


@dataclass(frozen=True, slots=True)
class RatedCase:
    """A case and its tip errors relative to the length: of the solver, and of the chain model."""

    case: StudyCase
    discretization: Discretization
    solver: float
    model: float | None

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
        solver = (least if error is None else error.maximum) / discretization.length
        found.append(RatedCase(case, discretization, solver, model))
    return tuple(sorted(found, key=lambda one: one.case.run_time))


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
