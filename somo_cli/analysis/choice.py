"""What to choose, from a study: the cheapest case that is good enough, and the balanced one."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.analysis.study import Case, Cut, Study


@dataclass(frozen=True, slots=True)
class Choice:
    """A case, and the error of its tip relative to the length: of the solver and of the chain."""

    case: Case
    cut: Cut
    solver: float
    model: float | None

    @property
    def larger(self) -> float:
        """The larger of the two errors; the two are never added, since neither knows its sign."""
        return max(self.solver, self.model or 0.0)


def choices(study: Study) -> tuple[Choice, ...]:
    """Return every case that ran to its end, with its errors; the cheapest first."""
    cuts = {cut.segments: cut for cut in study.cuts}
    found = []
    for case in study.cases:
        if case.status != "ok":
            continue
        cut = cuts[case.segments]
        model = None
        if study.model:
            least = study.model_error
            model = (least if cut.model is None else cut.model.maximum) / cut.length
        error = case.errors["tip_position"]
        least = cut.reference.error["tip_position"]
        solver = (least if error is None else error.maximum) / cut.length
        found.append(Choice(case, cut, solver, model))
    return tuple(sorted(found, key=lambda one: one.case.run_time))


def cheapest(study: Study, target: float) -> Choice | None:
    """Return the case of least run time whose errors are both at most `target` of the length."""
    return next((one for one in choices(study) if one.larger <= target), None)


def nearest(study: Study) -> Choice | None:
    """Return the case whose larger error is smallest."""
    return min(choices(study), key=lambda one: one.larger, default=None)


def balanced(study: Study) -> tuple[Choice, ...]:
    """Return, for each number of segments, the cheapest case whose solver errs less than its chain.

    More accurate steps would be wasted on such a chain, and fewer would waste its joints.
    """
    found: dict[int | None, Choice] = {}
    for one in choices(study):
        if one.model is not None and one.solver <= one.model:
            found.setdefault(one.case.segments, one)
    return tuple(found[cut.segments] for cut in study.cuts if cut.segments in found)
