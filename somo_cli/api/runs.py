"""Run a simulation from start to end: a document to a plan, a plan to rows, as `somo run` does."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np

from somo_cli import loading
from somo_cli.api.documents import Source, document_of
from somo_cli.api.result import Result
from somo_cli.arrays import Array
from somo_cli.document.parse import Document
from somo_cli.loading import Auto
from somo_cli.problems import Problem
from somo_cli.scene import columns
from somo_cli.scene.checks.recording import select_by_patterns
from somo_cli.scene.duration import steps_of
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.metadata import metadata
from somo_cli.simulation.monitoring.contact_events import ContactEvent
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import RunSummary, run


@dataclass(frozen=True, slots=True)
class PreparedRun:
    """A scene that can be run: its document, its plan, and the names of its columns."""

    document: Document
    scene: Scene
    plan: Plan
    names: tuple[str, ...]
    warnings: tuple[Problem, ...]

    def metadata(
        self, summary: RunSummary, overrides: Sequence[str] | None = None
    ) -> dict[str, Any]:
        """Return versions, hashes of the inputs, settings and run time, as plain values.

        `overrides` are the assignments with which the document was loaded, if they are known.
        """
        texts = self.document.texts
        known = [text for source, text in texts.items() if source.startswith("--set")]
        return metadata(
            self.plan,
            summary,
            texts,
            known if overrides is None else overrides,
            self.names,
            self.scene.is_time_step_automatic,
            self.scene.expected_tip_error,
        )


def prepare(
    document: Document, scene: Scene, warnings: Sequence[Problem], keeps_unused: bool = False
) -> PreparedRun:
    """Return the scene of a document, ready to run.

    With `keeps_unused` the engine also loads and solves what no result needs. Raises InvalidFile if
    bodies of the scene overlap at the start.
    """
    loading.refuse_overlaps(document, scene)
    plan = make_plan(scene, keeps_unused)
    names = tuple(columns.header(plan.recorded))
    return PreparedRun(document, scene, plan, names, tuple(warnings))


class OpenRun:
    """A plan in its own engine, opened by `with`, that can be run once.

    Opening raises EngineMissing and EngineRefused.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._world = BulletWorld(plan)

    def __enter__(self) -> OpenRun:
        self._world.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._world.close()

    def run(
        self,
        steps: int,
        write: Callable[[Array], None],
        advance: Callable[[int], None] = lambda done: None,
        on_event: Callable[[ContactEvent], None] | None = None,
        is_live: bool = False,
    ) -> RunSummary:
        """Run the plan and pass on its rows, as `simulation.run.run` does."""
        clock = time.perf_counter
        return run(self._plan, self._world, write, steps, clock, advance, on_event, is_live)


def simulate(
    source: Source,
    steps: int | None = None,
    *,
    duration: float | None = None,
    every: int | None = None,
    time_step: float | Auto | None = None,
    record_only: Sequence[str] = (),
    tolerance: float | Mapping[str, float] | None = None,
) -> Result:
    """Simulate a scene, or a definition alone, and return its recorded columns.

    The values are exactly those that `somo run` writes. `steps` or `duration` [s] says how long,
    else the duration of the scene; the number of steps is the nearest whole one. `every` (time
    steps between two rows) and `time_step` ([s], or "auto") replace the values of the scene;
    `record_only` has patterns of column names, such as "finger.tip.*".

    With a `tolerance` the step is halved, up to six times, until the estimated error of every
    column is below this share of its range, such as 1e-2, or below the values of a mapping such as
    {"cube.pose.*_m": 1e-4}, in the unit of the columns that match. Rows stay at the same instants.
    The metadata have the errors; a run that is not within the tolerance is a RuntimeWarning.

    Raises:
        InvalidFile: The scene has errors, each at its line and column.
        ValueError: A pattern matches no column, `steps` is negative, `steps` and `duration` are
            both given or neither, the scene included, or a tolerance is wrong.
        SimulationDiverged: The motion diverged, so that the results are not meaningful.
        EngineMissing, EngineRefused: There is no engine, or it cannot load a body.
        OSError: A file cannot be read.
    """
    document = document_of(source)
    scene, warnings = loading.scene_of(document, every, time_step)
    count = _steps_of(steps, duration, scene)
    if record_only:
        scene = select_by_patterns(scene, record_only)
    prepared = prepare(document, scene, warnings)
    if tolerance is not None:
        from somo_cli.api.refined import refined  # few runs need what it imports

        return refined(prepared, count, tolerance)
    blocks: list[Array] = [np.empty((0, len(prepared.names)))]
    # rows are views of a table that is new for each batch, so they can be kept
    with OpenRun(prepared.plan) as opened:
        summary = opened.run(count, blocks.append)
    return Result(prepared.names, np.concatenate(blocks), prepared.metadata(summary))


def _steps_of(steps: int | None, duration: float | None, scene: Scene) -> int:
    if steps is not None and duration is not None:
        raise ValueError("give steps or duration, not both")
    if steps is not None:
        if steps < 0:
            raise ValueError(f"steps is {steps}, but must not be negative")
        return steps
    asked = scene.duration if duration is None else duration
    if asked is None:
        raise ValueError("give steps or duration: the scene has no duration of its own")
    if not 0 < asked < math.inf:
        raise ValueError(f"duration is {asked}, but must be a positive number of seconds")
    return steps_of(asked, scene.time_step)
