"""Error against run time: a scene over time steps, integrators and numbers of segments."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from somo_cli.analysis import named, trial, variants
from somo_cli.analysis.errors import Error, profiles, summary
from somo_cli.analysis.instants import Instants
from somo_cli.analysis.reference import Reference, converged, extrapolated
from somo_cli.analysis.trial import Clock, OpenWorld
from somo_cli.arrays import Array
from somo_cli.problems import EngineRefused, SimulationDiverged
from somo_cli.simulation import columns
from somo_cli.simulation.plan import make_plan
from somo_cli.simulation.scene import Integrator, Quantity, Scene

Status = Literal["ok", "diverged", "refused"]
Told = Callable[[int], None]
"""Takes the number of time steps done so far."""


@dataclass(frozen=True, slots=True)
class Question:
    """What to run: steps [s], integrators, numbers of segments (None: the scene's), instants."""

    time_steps: tuple[float, ...]
    integrators: tuple[Integrator, ...]
    segments: tuple[int | None, ...]
    instants: Instants
    repeats: int


@dataclass(frozen=True, slots=True)
class Case:
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
    errors: dict[Quantity, Error | None] = dataclasses.field(default_factory=dict)
    order: float = math.nan


@dataclass(frozen=True, slots=True)
class Cut:
    """The scene at one number of segments: its reference, and how far the chain is from a beam.

    `length` [m] is that of the longest manipulator, `energy` [J] the most that one form of energy
    varied; `model` is the error of the tip against the continuum [m], None where it is unknown.
    """

    segments: int | None
    joints: int
    reference: Reference
    length: float
    energy: float
    model: Error | None = None


@dataclass(frozen=True, slots=True)
class Study:
    """The answer to a question; `model` says what the chain was held against, if anything."""

    question: Question
    scene: Scene
    cuts: tuple[Cut, ...]
    cases: tuple[Case, ...]
    model: str = ""
    model_error: float = math.nan


def work(question: Question) -> int:
    """Return how many time steps the cases and references take, roughly; for a progress bar."""
    instants = question.instants
    steps = [instants.count * instants.every(step) for step in question.time_steps]
    references = 14 * max(steps)
    cases = sum(steps) * len(question.integrators) * (1 + question.repeats)
    return len(question.segments) * (references + cases)


def study(
    scene: Scene, question: Question, open_world: OpenWorld, clock: Clock, advance: Told
) -> Study:
    """Run every case, one after the other, and measure errors and run times.

    Raises SimulationDiverged and EngineRefused if not even a reference can be made, and NotUniform
    of manipulator.segments for a scene that cannot be cut.
    """
    scene = variants.studied(scene)
    desk = _Desk(question, open_world, clock, advance)
    scenes = [scene if count is None else variants.cut(scene, count) for count in question.segments]
    cuts = [desk.cut(one, count) for one, count in zip(scenes, question.segments, strict=True)]
    cases = [
        case
        for one, cut in zip(scenes, cuts, strict=True)
        for integrator in question.integrators
        for case in desk.cases(one, cut, integrator)
    ]
    return _with_models(Study(question, scene, tuple(cuts), tuple(cases)), scenes)


class _Desk:
    """Runs scenes and counts the steps done."""

    def __init__(
        self, question: Question, open_world: OpenWorld, clock: Clock, advance: Told
    ) -> None:
        self._question = question
        self._open_world = open_world
        self._clock = clock
        self._advance = advance
        self._done = 0

    def cut(self, scene: Scene, count: int | None) -> Cut:
        """Return the reference of a scene: half the smallest step and below, else a closed form."""
        plan = make_plan(scene)
        smallest = min(self._question.time_steps)

        def recorded(time_step: float) -> Array:
            return self._recorded(scene, "implicit", time_step)

        reference = converged(plan, smallest / 2, recorded)
        reference = named.exact(scene, reference)
        energies = [group for group in columns.groups(plan) if group.quantity == "energy"]
        spans = [np.ptp(reference.rows[:, one.first : one.last], axis=0).max() for one in energies]
        chains = [one.compiled.chain for one in scene.manipulators]
        return Cut(
            segments=count,
            joints=sum(len(chain.joints) for chain in chains),
            reference=reference,
            length=max(chain.length for chain in chains),
            energy=float(max(spans)),
        )

    def cases(self, scene: Scene, cut: Cut, integrator: Integrator) -> list[Case]:
        """Return the cases of one integrator, large steps first."""
        found: list[Case] = []
        for time_step in sorted(self._question.time_steps, reverse=True):
            case = self._case(scene, cut, integrator, time_step)
            if found:
                case = dataclasses.replace(case, order=_order(found[-1], case))
            found.append(case)
        return found

    def _case(self, scene: Scene, cut: Cut, integrator: Integrator, time_step: float) -> Case:
        instants = self._question.instants
        every = instants.every(time_step)
        steps = instants.count * every
        case = Case(cut.segments, integrator, time_step, steps, "ok")
        plan = make_plan(variants.stepped(scene, integrator, time_step, every))
        repeats = self._question.repeats
        try:
            rows = self._recorded(scene, integrator, time_step)
            taken = trial.run_time(plan, steps, self._open_world, self._clock, repeats)
        except SimulationDiverged as error:
            return dataclasses.replace(case, status="diverged", reason=str(error))
        except EngineRefused as error:
            return dataclasses.replace(case, status="refused", reason=str(error))
        finally:
            self._count(repeats * steps)
        reference = cut.reference
        errors = {
            quantity: _told(profile, reference.error[quantity])
            for quantity, profile in profiles(plan, rows, reference.rows).items()
        }
        return dataclasses.replace(case, run_time=taken, errors=errors)

    def _recorded(self, scene: Scene, integrator: Integrator, time_step: float) -> Array:
        instants = self._question.instants
        # the reference's steps are halves of the question's, so they meet the instants as well
        every = instants.every(time_step)
        plan = make_plan(variants.stepped(scene, integrator, time_step, every))
        try:
            return trial.recorded(plan, instants.count * every, self._open_world)
        finally:
            self._count(instants.count * every)

    def _count(self, steps: int) -> None:
        self._done += steps
        self._advance(self._done)


def _told(profile: Array, least: float) -> Error | None:
    error = summary(profile)
    return error if error.maximum > least else None


def _order(coarse: Case, fine: Case) -> float:
    errors = [case.errors.get("tip_position") for case in (coarse, fine)]
    if errors[0] is None or errors[1] is None or errors[1].maximum == 0:
        return math.nan
    ratio = errors[0].maximum / errors[1].maximum
    return math.log(ratio) / math.log(coarse.time_step / fine.time_step)


def _with_models(answer: Study, scenes: Sequence[Scene]) -> Study:
    """Add how far each chain is from its continuum: a closed form, else the limit of many joints.

    The limit needs three numbers of segments in one ratio.
    """
    cuts = answer.cuts
    if answer.scene.reference in named.CONTINUUM:
        beams = [
            named.beam_tip(scene, cut.reference) for scene, cut in zip(scenes, cuts, strict=True)
        ]
        models: list[Error | None] = [Error(one.apart, one.apart, one.apart) for one in beams]
        name, error = str(answer.scene.reference), max(one.error for one in beams)
    else:
        limit = _limit(answer, scenes)
        if limit is None:
            return answer
        models, error = limit
        name = "the limit of many segments"
    told = [None if model is None or model.maximum <= error else model for model in models]
    cuts = tuple(
        dataclasses.replace(cut, model=model) for cut, model in zip(cuts, told, strict=True)
    )
    return dataclasses.replace(answer, cuts=cuts, model=name, model_error=error)


def _limit(answer: Study, scenes: Sequence[Scene]) -> tuple[list[Error | None], float] | None:
    counted = sorted(
        (cut.segments, index) for index, cut in enumerate(answer.cuts) if cut.segments is not None
    )
    if len(counted) < 3:
        return None
    (n1, _), (n2, _), (n3, _) = counted[-3:]
    if n2 * n2 != n1 * n3:
        return None
    tips = [make_plan(dataclasses.replace(scene, columns=("tip_position",))) for scene in scenes]
    plan = tips[counted[-1][1]]
    rows = [
        _tips(scene, cut.reference.rows) for scene, cut in zip(scenes, answer.cuts, strict=True)
    ]
    levels = [rows[index] for _, index in counted[-3:]]
    limit = extrapolated(plan, levels, n3 / n2)
    models: list[Error | None] = [
        summary(profiles(plan, one, limit.rows)["tip_position"]) for one in rows
    ]
    return models, limit.error["tip_position"]


def _tips(scene: Scene, rows: Array) -> Array:
    """Return time and tip positions alone, in the order of the bodies."""
    parts = [
        rows[:, group.first : group.last]
        for group in columns.groups(make_plan(scene))
        if group.quantity == "tip_position"
    ]
    return np.hstack([rows[:, :1], *parts])
