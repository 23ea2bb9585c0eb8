"""The source of somo render: a scene, which is simulated, or a CSV that somo run recorded."""

from __future__ import annotations

import dataclasses
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from somo_cli import files, terminal
from somo_cli.budget import Budget
from somo_cli.cli.render_again import (
    Repetition,
    difference_lines,
    missing_columns,
    problem_of,
)
from somo_cli.cli.run_outputs import beside
from somo_cli.cli.tables import MAX_TABLE_BYTES, read_table_file
from somo_cli.problems import InvalidFile, Problem, Span

if TYPE_CHECKING:
    from somo_cli.arrays import Array
    from somo_cli.document.parse import Document
    from somo_cli.packages import Access
    from somo_cli.picture.recorded_motion import RecordedMotion
    from somo_cli.scene.model import Scene
    from somo_cli.simulation.run import RunSummary

_BETWEEN = 8  # rows from picture to picture, if pictures do not fall on time steps


def is_recording(source: str) -> bool:
    """Return whether a source is a CSV of `somo run`, not a scene."""
    return source.lower().endswith(".csv")


def read_scene(
    path: str, sets: Sequence[str], access: Access, time_step: float | None = None
) -> tuple[Document, Scene]:
    """Read a scene and print its warnings. Raises OSError and InvalidFile.

    `time_step` [s] replaces that of the scene.
    """
    from somo_cli import loading

    document = loading.load(path, sets, *access)
    scene, warnings = loading.scene_of(document, None, time_step)
    terminal.print_problems(warnings, document.texts)
    return document, scene


def simulated(
    document: Document, scene: Scene, steps: int, budget: Budget, every: float | None = None
) -> tuple[RecordedMotion, RunSummary]:
    """Simulate a scene for `steps` time steps and return its recording, with the last step.

    With `every` [s] rows are at its multiples if these fall on time steps, or several times as
    dense. Raises the errors of a run.
    """
    from somo_cli import loading
    from somo_cli.picture.recorded_motion import RecordedMotion, scene_to_draw
    from somo_cli.scene import columns
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.engine.bullet.world import BulletWorld
    from somo_cli.simulation.plan.build import make_plan
    from somo_cli.simulation.run import run

    loading.refuse_overlaps(document, scene)
    between = max(steps, 1) if every is None else _steps_between(every / scene.time_step)
    plan = make_plan(dataclasses.replace(scene_to_draw(scene), every=between))
    plan = dataclasses.replace(plan, records_last_step=True)
    blocks: list[Array] = []
    with (
        stdout_to_stderr(),
        BulletWorld(plan) as world,
        terminal.progress(steps, "simulating", budget) as advance,
    ):
        summary = run(plan, world, blocks.append, steps, time.perf_counter, advance)
    names = columns.header(plan.recorded)
    rows = [row for block in blocks for row in block.tolist()]
    table = dict(zip(names, zip(*rows, strict=True), strict=True))
    return RecordedMotion(scene, table), summary


def recorded(
    path: str,
    scene: str | None,
    sets: Sequence[str],
    access: Access,
    simulate: Callable[[Document, RecordedMotion], RecordedMotion] | None = None,
) -> tuple[Document, RecordedMotion]:
    """Read a CSV of `somo run` and its scene. Raises OSError and InvalidFile.

    The scene is the one given, or else the one that the `.meta.json` beside the CSV names, with the
    values that were overridden. Where the CSV lacks columns, `simulate` simulates the scene again,
    unless it is None; a warning says if the result is another.
    """
    from somo_cli.document.table import require_columns
    from somo_cli.picture.recorded_motion import RecordedMotion

    table = read_table_file(path)
    require_columns(table, increasing="time_s")
    about = _about(path, scene is None)
    overrides = [*about.get("overrides", ()), *sets]
    step = about.get("time_step_s")
    time_step = step if isinstance(step, float) and 0 < step <= 1 else None
    named = scene or os.path.normpath(Path(path).parent / about["scene"])
    try:
        document, found = read_scene(named, overrides, access, time_step)
    except FileNotFoundError as error:
        if scene is not None:
            raise
        message = f"the scene of this recording, {named}, does not exist"
        place = Span(beside(path, "meta.json"), 1, 1)
        raise InvalidFile([Problem(place, message, "name it with --scene")]) from error
    terminal.print_problems(_changes(about.get("inputs", {}), document), document.texts)
    recording = RecordedMotion(found, table.columns)
    missing = missing_columns(recording)
    if missing and simulate is not None:
        again = simulate(document, recording)
        terminal.print_lines(difference_lines(recording, again))
        return document, again
    if missing:
        run = Repetition(named, overrides, time_step, recording.times[-1], path)
        raise InvalidFile([problem_of(missing, recording, table, run)], table.texts)
    return document, recording


def _steps_between(steps: float) -> int:
    """Return the steps between rows, for pictures that are `steps` time steps apart."""
    nearest = round(steps)
    if nearest >= 1 and abs(steps - nearest) <= 1e-6 * steps:
        return nearest
    return max(1, int(steps / _BETWEEN))


def _about(path: str, is_needed: bool) -> Mapping[str, Any]:
    """Return the `.meta.json` beside a CSV; empty if it is missing and not needed."""
    name = beside(path, "meta.json")
    hint = "record it again, or name the scene with --scene"
    try:
        data: Any = json.loads(files.read_text(name, MAX_TABLE_BYTES))
    except FileNotFoundError as error:
        if not is_needed:
            return {}
        message = f"there is no {Path(name).name} beside it, which names its scene"
        raise InvalidFile([Problem(Span(path, 1, 1), message, hint)]) from error
    except json.JSONDecodeError as error:
        place = Span(name, error.lineno, error.colno)
        raise InvalidFile([Problem(place, f"this is not JSON: {error.msg}", hint)]) from error
    found = data if isinstance(data, dict) else {}
    about = {"scene": "", "inputs": {}, "overrides": [], **found}
    is_sound = isinstance(about["scene"], str) and isinstance(about["inputs"], dict)
    is_sound = is_sound and isinstance(about["overrides"], list)
    is_sound = is_sound and all(isinstance(one, str) for one in about["overrides"])
    if not is_sound or (is_needed and not about["scene"]):
        message = "this does not name the scene of the recording"
        raise InvalidFile([Problem(Span(name, 1, 1), message, hint)])
    return about


def _changes(inputs: Mapping[str, Any], document: Document) -> Iterator[Problem]:
    """Yield a warning for each file of a scene that has changed since the run."""
    import hashlib  # slow to import, and not needed by other commands

    first = next(iter(inputs), "")
    recorded_hashes = {_relative(source, first): one for source, one in inputs.items()}
    for source, text in document.texts.items():
        recorded_hash = recorded_hashes.get(_relative(source, document.source))
        content = text.encode("utf-8", "surrogateescape")
        present = {"sha256": hashlib.sha256(content).hexdigest()}
        if recorded_hash not in (None, present):
            message = "this file has changed since the run was recorded"
            hint = "the picture shows the recorded motion with the present shapes"
            yield Problem(Span(source, 1, 1), message, hint, "warning")


def _relative(source: str, to: str) -> str:
    try:
        return os.path.relpath(source, Path(to).parent)
    except ValueError:  # on another drive
        return source
