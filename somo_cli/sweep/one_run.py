"""One run of a study: a parameter set to the values of its labels, whatever happens."""

from __future__ import annotations

import json
import time
import traceback
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from somo_cli import loading, output_files
from somo_cli.api import runs
from somo_cli.api.result import Result
from somo_cli.arrays import Array
from somo_cli.document.parse import Document
from somo_cli.packages import Packages
from somo_cli.problems import InvalidFile, Pointer, SimulationDiverged, SomoError, pointer_text
from somo_cli.scene.checks.recording import select_by_patterns
from somo_cli.scene.columns import header
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.run import RunSummary
from somo_cli.sweep.label_values import is_kept, label_values
from somo_cli.sweep.study import Point, Study, error_name


class ColumnMissing(SomoError):
    """A set of parameters whose scene has no column that a label needs."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run ended.

    `status` is done, diverged, invalid, failed, crashed or timed out; `log` says more than
    `reason`, which is one line.
    """

    status: str
    labels: dict[str, Any] = field(default_factory=dict)
    findings: tuple[str, ...] = ()
    reason: str = ""
    run_time: float = 0.0  # s, of the stepping loop
    log: str = ""

    @property
    def is_good(self) -> bool:
        """Whether the run has its labels."""
        return self.status == "done"


@dataclass(frozen=True, slots=True)
class StudyRunner:
    """Runs sets of a study; `scene` is its document with all files included.

    `folder` is where trajectories are kept, in a numbered folder for each run.
    """

    study: Study
    scene: Document
    folder: str
    allow_outside: bool = False
    packages: Packages | None = None

    def document(self, point: Point) -> Document:
        """Return the document of the scene with a set of parameters. Raises InvalidFile."""
        sets = [
            f"{path_of(pointer)}={json.dumps(point[parameter.name])}"
            for parameter in self.study.parameters
            for pointer in parameter.targets
        ]
        return loading.with_overrides(self.scene, sets, self.allow_outside, self.packages)

    def check(self, point: Point) -> Outcome:
        """Compile and check a set of parameters without running it."""
        try:
            document = self.document(point)
            found, _ = loading.scene_of(document)
            loading.refuse_overlaps(document, found)
        except (SomoError, OSError) as error:
            return _failed(error)
        return Outcome("done")

    def run(self, number: int, point: Point) -> Outcome:
        """Run a set of parameters; every error is an outcome."""
        started = time.perf_counter()
        try:
            return self._run(number, point)
        except (SomoError, OSError) as error:
            return _failed(error, time.perf_counter() - started)
        except Exception as error:
            # a fault of ours must not end a sweep of hours; the log tells where it was
            log = traceback.format_exc()
            return Outcome("failed", reason=f"{type(error).__name__}: {error}", log=log)

    def _run(self, number: int, point: Point) -> Outcome:
        document = self.document(point)
        prepared, summary, rows = self._simulated(document)
        values: dict[str, Any] = dict(label_values(self.study.labels, point, prepared.names, rows))
        findings = [one.code for one in summary.findings]
        run_time = summary.wall_time
        if self.study.has_errors:
            finer, of_finer, finer_rows = self._simulated(document, prepared.scene)
            other = label_values(self.study.labels, point, finer.names, finer_rows)
            values |= {error_name(name): _change(values[name], other[name]) for name in other}
            run_time += of_finer.wall_time
        if is_kept(self.study.keep, point, values):
            self._keep(number, prepared, summary, rows)
        return Outcome("done", values, tuple(findings), run_time=run_time)

    def _simulated(
        self, document: Document, halved: Scene | None = None
    ) -> tuple[runs.PreparedRun, RunSummary, Array]:
        """Run a document, at half the step of a scene if one is given, with rows at its times."""
        if halved is None:
            found, warnings = loading.scene_of(document)
        else:
            step, every = halved.time_step / 2, 2 * halved.every
            found, warnings = loading.scene_of(document, every, step)
        prepared = runs.prepare(document, self._recording(found), warnings)
        steps = self.study.steps_at(prepared.plan.time_step)
        if halved is not None:
            steps = 2 * self.study.steps_at(halved.time_step)
        blocks: list[Array] = [np.empty((0, len(prepared.names)))]
        with runs.OpenRun(prepared.plan) as opened:
            summary = opened.run(steps, blocks.append)
        return prepared, summary, np.concatenate(blocks)

    def _keep(
        self, number: int, prepared: runs.PreparedRun, summary: RunSummary, rows: Array
    ) -> None:
        """Keep the trajectory of a run, and what is known of it."""
        folder = Path(self.folder) / f"{number:04d}"
        folder.mkdir(parents=True, exist_ok=True)
        about = prepared.metadata(summary)
        Result(prepared.names, rows, about).to_csv(folder / "trajectory.csv")
        text = json.dumps(about, indent=2) + "\n"
        output_files.write_atomically(str(folder / "trajectory.meta.json"), text)

    def _recording(self, found: Scene) -> Scene:
        """Return the scene with the columns of labels; with its own where trajectories are kept."""
        columns = [*self.study.columns]
        if self.study.keep is not False:
            columns = [*header(make_plan(found).recorded)[1:], *columns]
        try:
            return select_by_patterns(found, list(dict.fromkeys(columns))) if columns else found
        except ValueError as error:
            raise ColumnMissing(str(error)) from error


def _change(value: Any, finer: Any) -> Any:
    """Return how far two values are apart; of outcomes, whether they differ."""
    if isinstance(value, bool) or isinstance(finer, bool):
        return value != finer
    return abs(float(value) - float(finer))


def path_of(pointer: Pointer) -> str:
    """Return a pointer as `--set` takes it."""
    return pointer_text(pointer).strip("'")


def _failed(error: SomoError | OSError, run_time: float = 0.0) -> Outcome:
    if isinstance(error, SimulationDiverged):
        return Outcome("diverged", reason=str(error), run_time=run_time, log=str(error))
    if isinstance(error, InvalidFile):
        problems = [one for one in error.problems if one.severity == "error"] or error.problems
        log = "\n".join(map(str, problems))
        return Outcome("invalid", reason=problems[0].message, log=log)
    status = "invalid" if isinstance(error, ColumnMissing) else "failed"
    return Outcome(status, reason=str(error), log=str(error))
