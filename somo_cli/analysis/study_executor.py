"""Run the cases of a study: references, errors and run times."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np

from somo_cli.analysis import closed_form_references, recorded_run, scene_variants
from somo_cli.analysis.errors import ErrorSummary, error_profiles, summarize_errors
from somo_cli.analysis.recorded_errors import case_errors, reference_errors
from somo_cli.analysis.recorded_run import Clock, OpenWorld, RecordedRun, record_run
from somo_cli.analysis.reference import converged_reference
from somo_cli.analysis.study_model import Discretization, StudyCase, StudySettings
from somo_cli.arrays import Array
from somo_cli.problems import EngineRefused, SimulationDiverged
from somo_cli.scene import columns
from somo_cli.scene.model import Integrator, Scene
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan

ProgressCallback = Callable[[int], None]
"""Receives the number of time steps done so far."""


class StudyExecutor:
    """Runs the cases of a study and counts the time steps done."""

    def __init__(
        self,
        settings: StudySettings,
        open_world: OpenWorld,
        clock: Clock,
        advance: ProgressCallback,
    ) -> None:
        self._settings = settings
        self._open_world = open_world
        self._clock = clock
        self._advance = advance
        self._done = 0
        self._finest: dict[int | None, Array] = {}
        self._recorded_names: dict[int | None, frozenset[str]] = {}

    def discretization(
        self, scene: Scene, count: int | None, recorded_names: frozenset[str]
    ) -> Discretization:
        """Return a scene with its reference: a closed form, or the limit of runs with small steps.

        `recorded_names` are the columns that the scene itself records. Raises SimulationDiverged
        and EngineRefused.
        """
        plan = make_plan(scene)
        smallest = min(self._settings.time_steps)
        runs: list[RecordedRun] = []

        def recorded(time_step: float) -> Array:
            runs.append(self._recorded(scene, "implicit", time_step))
            return runs[-1].rows

        reference = converged_reference(plan, smallest / 2, recorded)
        errors = None
        if _has_more_than_tips(plan):
            levels = [one.rows for one in runs[-3:]]
            errors = reference_errors(plan, levels, recorded_names, runs[-1].events)
            self._finest[count] = runs[-1].rows
            self._recorded_names[count] = recorded_names
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
            recorded=errors,
        )

    def cases(
        self, scene: Scene, discretization: Discretization, integrator: Integrator
    ) -> list[StudyCase]:
        """Run the cases of one integrator, the largest step first."""
        found: list[StudyCase] = []
        for time_step in sorted(self._settings.time_steps, reverse=True):
            case = self._case(scene, discretization, integrator, time_step)
            if found:
                case = dataclasses.replace(case, order=_order(found[-1], case))
            found.append(case)
        return found

    def _case(
        self, scene: Scene, discretization: Discretization, integrator: Integrator, time_step: float
    ) -> StudyCase:
        instants = self._settings.instants
        every = instants.steps_between(time_step)
        steps = instants.count * every
        case = StudyCase(discretization.segments, integrator, time_step, steps, "ok")
        plan = make_plan(scene_variants.with_time_step(scene, integrator, time_step, every))
        repeats = self._settings.repeats
        try:
            found = self._recorded(scene, integrator, time_step)
            run_time = recorded_run.median_run_time(
                plan, steps, self._open_world, self._clock, repeats, self._advance_within
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
            for quantity, profile in error_profiles(plan, found.rows, reference.rows).items()
        }
        recorded = None
        if discretization.recorded is not None:
            finest = self._finest[case.segments]
            names = self._recorded_names[case.segments]
            recorded = case_errors(plan, found.rows, finest, names, found.events)
        return dataclasses.replace(case, run_time=run_time, errors=errors, recorded=recorded)

    def _recorded(self, scene: Scene, integrator: Integrator, time_step: float) -> RecordedRun:
        instants = self._settings.instants
        # the reference takes fractions of the smallest step, so it meets the instants too
        every = instants.steps_between(time_step)
        plan = make_plan(scene_variants.with_time_step(scene, integrator, time_step, every))
        try:
            return record_run(plan, instants.count * every, self._open_world, self._advance_within)
        finally:
            self._count(instants.count * every)

    def _advance_within(self, step: int) -> None:
        self._advance(self._done + step)

    def _count(self, steps: int) -> None:
        self._done += steps
        self._advance(self._done)


def _has_more_than_tips(plan: Plan) -> bool:
    """Whether there is contact or an object, of which tips and angles say nothing."""
    return plan.can_touch or bool(plan.objects)


def _resolved_error(profile: Array, least: float) -> ErrorSummary | None:
    error = summarize_errors(profile)
    return error if error.maximum > least else None


def _order(coarse: StudyCase, fine: StudyCase) -> float:
    errors = [case.errors.get("tip_position") for case in (coarse, fine)]
    if errors[0] is None or errors[1] is None or errors[1].maximum == 0:
        return math.nan
    ratio = errors[0].maximum / errors[1].maximum
    return math.log(ratio) / math.log(coarse.time_step / fine.time_step)
