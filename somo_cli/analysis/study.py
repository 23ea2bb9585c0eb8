"""Error against run time: a scene over time steps, integrators and numbers of segments."""

from __future__ import annotations

from somo_cli.analysis import scene_variants
from somo_cli.analysis.model_error import with_model_errors
from somo_cli.analysis.recorded_run import Clock, OpenWorld
from somo_cli.analysis.study_executor import ProgressCallback, StudyExecutor
from somo_cli.analysis.study_model import Study, StudySettings
from somo_cli.scene.model import Scene


def total_steps(settings: StudySettings) -> int:
    """Return roughly how many time steps all cases and references take, for a progress bar."""
    instants = settings.instants
    steps = [instants.count * instants.steps_between(step) for step in settings.time_steps]
    references = 14 * max(steps)
    cases = sum(steps) * len(settings.integrators) * (1 + settings.repeats)
    return len(settings.segments) * (references + cases)


def study(
    scene: Scene,
    settings: StudySettings,
    open_world: OpenWorld,
    clock: Clock,
    advance: ProgressCallback,
) -> Study:
    """Run every case, one after the other, and measure errors and run times.

    Raises SimulationDiverged and EngineRefused if a reference cannot be computed, and
    `resegmentation.NotUniform` if actuators cannot be divided into other numbers of segments.
    """
    own, scene = scene, scene_variants.study_variant(scene)
    executor = StudyExecutor(settings, open_world, clock, advance)
    scenes = [
        scene if count is None else scene_variants.with_segments(scene, count)
        for count in settings.segments
    ]
    discretizations = [
        executor.discretization(one, count, scene_variants.recorded_names(one, own))
        for one, count in zip(scenes, settings.segments, strict=True)
    ]
    cases = [
        case
        for one, discretization in zip(scenes, discretizations, strict=True)
        for integrator in settings.integrators
        for case in executor.cases(one, discretization, integrator)
    ]
    return with_model_errors(Study(settings, scene, tuple(discretizations), tuple(cases)), scenes)
