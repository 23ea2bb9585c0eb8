"""ErrorSummary against run time: a scene over time steps, integrators and numbers of segments."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from somo_cli.analysis import closed_form_references, recorded_run, scene_variants
from somo_cli.analysis.common_instants import Instants
from somo_cli.analysis.errors import ErrorSummary, error_profiles, summarize_errors
from somo_cli.analysis.recorded_run import Clock, OpenWorld
from somo_cli.analysis.reference import Reference, converged_reference, extrapolate
from somo_cli.arrays import Array
from somo_cli.problems import EngineRefused, SimulationDiverged
from somo_cli.scene import columns
from somo_cli.scene.model import Integrator, Quantity, Scene
from somo_cli.simulation.plan.model import make_plan

Status = Literal["ok", "diverged", "refused"]
ProgressCallback = Callable[[int], None]
"""Takes the number of time steps done so far."""


@dataclass(frozen=True, slots=True)
class StudySettings:
    """What to run: steps [s], integrators, numbers of segments (None: the scene's), instants."""

    time_steps: tuple[float, ...]
    integrators: tuple[Integrator, ...]
    segments: tuple[int | None, ...]
    instants: Instants
    repeats: int


@dataclass(frozen=True, slots=True)
class StudyCase:
    """One run: the errors of its solver, and what it took; times in seconds.

    An error is None where it is smaller than that of the reference. The order is that in which
    the largest error of the tip fell from the next larger step.
    """

    segments: int | None
    integrator: Integrator
    time_step: float
    steps: int
    status: Status
    reason: str = ""
    run_time: float = math.nan
    errors: dict[Quantity, ErrorSummary | None] = dataclasses.field(default_factory=dict)
    order: float = math.nan


@dataclass(frozen=True, slots=True)
class Discretization:
    """The scene at one number of segments: its reference, and how far the chain is from a beam.

    `length` [m] is that of the longest manipulator, `energy` [J] the most that one form of energy
    varied; `model` is the error of the tip against the continuum [m], None where it is unknown.
    """

    segments: int | None
    joints: int
    reference: Reference
    length: float
    energy: float
    model: ErrorSummary | None = None


@dataclass(frozen=True, slots=True)
class Study:
    """The answer to a question; `model` says what the chain was held against, if anything."""

    question: StudySettings
    scene: Scene
    discretizations: tuple[Discretization, ...]
    cases: tuple[StudyCase, ...]
    model: str = ""
    model_error: float = math.nan


def total_steps(question: StudySettings) -> int:
    """Return how many time steps the cases and references take, roughly; for a progress bar."""
    instants = question.instants
    steps = [instants.count * instants.steps_between(step) for step in question.time_steps]
    references = 14 * max(steps)
    cases = sum(steps) * len(question.integrators) * (1 + question.repeats)
    return len(question.segments) * (references + cases)


def study(
    scene: Scene,
    question: StudySettings,
    open_world: OpenWorld,
    clock: Clock,
    advance: ProgressCallback,
) -> Study:
    """Run every case, one after the other, and measure errors and run times.

    Raises SimulationDiverged and EngineRefused if not even a reference can be made, and NotUniform
    of manipulator.segments for a scene that cannot be discretization.
    """
    scene = scene_variants.study_variant(scene)
    executor = _StudyExecutor(question, open_world, clock, advance)
    scenes = [
        scene if count is None else scene_variants.with_segments(scene, count)
        for count in question.segments
    ]
    discretizations = [
        executor.discretization(one, count)
        for one, count in zip(scenes, question.segments, strict=True)
    ]
    cases = [
        case
        for one, discretization in zip(scenes, discretizations, strict=True)
        for integrator in question.integrators
        for case in executor.cases(one, discretization, integrator)
    ]
    return _with_model_errors(Study(question, scene, tuple(discretizations), tuple(cases)), scenes)


class _StudyExecutor:
    """Runs scenes and counts the steps done."""

    def __init__(
        self,
        question: StudySettings,
        open_world: OpenWorld,
        clock: Clock,
        advance: ProgressCallback,
    ) -> None:
        self._question = question
        self._open_world = open_world
        self._clock = clock
        self._advance = advance
        self._done = 0

    def discretization(self, scene: Scene, count: int | None) -> Discretization:
        """Return the reference of a scene: half the smallest step and below, else a closed form."""
        plan = make_plan(scene)
        smallest = min(self._question.time_steps)

        def recorded(time_step: float) -> Array:
            return self._recorded(scene, "implicit", time_step)

        reference = converged_reference(plan, smallest / 2, recorded)
        reference = closed_form_references.with_closed_form(scene, reference)
        energies = [
            group
            for group in columns.body_column_groups(plan.recorded)
            if group.quantity == "energy"
        ]
        spans = [np.ptp(reference.rows[:, one.first : one.last], axis=0).max() for one in energies]
        chains = [one.compiled.chain for one in scene.manipulators]
        return Discretization(
            segments=count,
            joints=sum(len(chain.joints) for chain in chains),
            reference=reference,
            length=max(chain.length for chain in chains),
            energy=float(max(spans)),
        )

    def cases(
        self, scene: Scene, discretization: Discretization, integrator: Integrator
    ) -> list[StudyCase]:
        """Return the cases of one integrator, large steps first."""
        found: list[StudyCase] = []
        for time_step in sorted(self._question.time_steps, reverse=True):
            case = self._case(scene, discretization, integrator, time_step)
            if found:
                case = dataclasses.replace(case, order=_order(found[-1], case))
            found.append(case)
        return found

    def _case(
        self, scene: Scene, discretization: Discretization, integrator: Integrator, time_step: float
    ) -> StudyCase:
        instants = self._question.instants
        every = instants.steps_between(time_step)
        steps = instants.count * every
        case = StudyCase(discretization.segments, integrator, time_step, steps, "ok")
        plan = make_plan(scene_variants.with_time_step(scene, integrator, time_step, every))
        repeats = self._question.repeats
        try:
            rows = self._recorded(scene, integrator, time_step)
            run_time = recorded_run.median_run_time(
                plan, steps, self._open_world, self._clock, repeats
            )
        except SimulationDiverged as error:
            return dataclasses.replace(case, status="diverged", reason=str(error))
        except EngineRefused as error:
            return dataclasses.replace(case, status="refused", reason=str(error))
        finally:
            self._count(repeats * steps)
        reference = discretization.reference
        errors = {
            quantity: _resolved_error(profile, reference.error[quantity])
            for quantity, profile in error_profiles(plan, rows, reference.rows).items()
        }
        return dataclasses.replace(case, run_time=run_time, errors=errors)

    def _recorded(self, scene: Scene, integrator: Integrator, time_step: float) -> Array:
        instants = self._question.instants
        # the reference's steps are halves of the question's, so they meet the instants as well
        every = instants.steps_between(time_step)
        plan = make_plan(scene_variants.with_time_step(scene, integrator, time_step, every))
        try:
            return recorded_run.record_rows(plan, instants.count * every, self._open_world)
        finally:
            self._count(instants.count * every)

    def _count(self, steps: int) -> None:
        self._done += steps
        self._advance(self._done)


def _resolved_error(profile: Array, least: float) -> ErrorSummary | None:
    error = summarize_errors(profile)
    return error if error.maximum > least else None


def _order(coarse: StudyCase, fine: StudyCase) -> float:
    errors = [case.errors.get("tip_position") for case in (coarse, fine)]
    if errors[0] is None or errors[1] is None or errors[1].maximum == 0:
        return math.nan
    ratio = errors[0].maximum / errors[1].maximum
    return math.log(ratio) / math.log(coarse.time_step / fine.time_step)


def _with_model_errors(answer: Study, scenes: Sequence[Scene]) -> Study:
    """Add how far each chain is from its continuum: a closed form, else the limit of many joints.

    The limit needs three numbers of segments in one ratio.
    """
    discretizations = answer.discretizations
    if answer.scene.reference in closed_form_references.CONTINUUM:
        beams = [
            closed_form_references.beam_tip(scene, discretization.reference)
            for scene, discretization in zip(scenes, discretizations, strict=True)
        ]
        models: list[ErrorSummary | None] = [
            ErrorSummary(one.distance, one.distance, one.distance) for one in beams
        ]
        name, error = str(answer.scene.reference), max(one.error for one in beams)
    else:
        limit = _segment_limit(answer, scenes)
        if limit is None:
            return answer
        models, error = limit
        name = "the limit of many segments"
    told = [None if model is None or model.maximum <= error else model for model in models]
    discretizations = tuple(
        dataclasses.replace(discretization, model=model)
        for discretization, model in zip(discretizations, told, strict=True)
    )
    return dataclasses.replace(
        answer, discretizations=discretizations, model=name, model_error=error
    )


def _segment_limit(
    answer: Study, scenes: Sequence[Scene]
) -> tuple[list[ErrorSummary | None], float] | None:
    counted = sorted(
        (discretization.segments, index)
        for index, discretization in enumerate(answer.discretizations)
        if discretization.segments is not None
    )
    if len(counted) < 3:
        return None
    (n1, _), (n2, _), (n3, _) = counted[-3:]
    if n2 * n2 != n1 * n3:
        return None
    tips = [make_plan(dataclasses.replace(scene, columns=("tip_position",))) for scene in scenes]
    plan = tips[counted[-1][1]]
    rows = [
        _tips(scene, discretization.reference.rows)
        for scene, discretization in zip(scenes, answer.discretizations, strict=True)
    ]
    levels = [rows[index] for _, index in counted[-3:]]
    limit = extrapolate(plan, levels, n3 / n2)
    models: list[ErrorSummary | None] = [
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
