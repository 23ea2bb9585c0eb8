"""One run of a study's scene, its columns in memory; several at once on all cores."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np

from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.run import RunSummary
from tests.builders.runs import simulated
from tests.builders.scenes import scene_from_file


@dataclass(frozen=True, slots=True)
class Setting:
    """A scene of definitions/, what is set in it as by `--set`, and for how long it runs [s]."""

    scene: str
    seconds: float
    sets: tuple[str, ...] = ()
    time_step: float | None = None
    """In place of the scene's [s]; what is recorded stays as far apart in time."""


@dataclass(frozen=True, slots=True)
class Record:
    """The columns of a run by their names in the CSV, SI, and its summary but for the wall time."""

    columns: dict[str, Array]
    summary: RunSummary

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]


def recorded(setting: Setting) -> Record:
    """Run a scene by the same stages as `somo run`; raises SimulationDiverged."""
    scene = scene_from_file(setting.scene, *setting.sets)
    if setting.time_step is not None:
        every = max(1, round(scene.every * scene.time_step / setting.time_step))
        scene = dataclasses.replace(scene, time_step=setting.time_step, every=every)
    plan = make_plan(scene)
    rows, summary = simulated(plan, round(setting.seconds / plan.time_step))
    table = dict(zip(columns.header(plan.recorded), np.array(rows).T, strict=True))
    return Record(table, summary)


def recorded_all(settings: Sequence[Setting], processes: int | None = None) -> list[Record]:
    """Run scenes side by side, one process for each core by default; return them in order."""
    count = processes or os.cpu_count() or 1
    if count == 1 or len(settings) < 2:
        return [recorded(setting) for setting in settings]
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        return list(pool.map(recorded, settings))
