"""Runs of scenes in the engine, and their rows and columns as arrays."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from somo_cli.analysis.error_estimate import ErrorEstimate, estimate
from somo_cli.analysis.spooled_run import LevelRunner
from somo_cli.arrays import Array
from somo_cli.files import temporary_file
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import RunSummary
from tests.builders.definitions import Data
from tests.builders.scenes import scene_from_text


def rows_of(scene_or_plan: Scene | Plan, steps: int) -> list[list[float]]:
    """Simulate and return the recorded rows."""
    return simulated(scene_or_plan, steps)[0]


def simulated(scene_or_plan: Scene | Plan, steps: int) -> tuple[list[list[float]], RunSummary]:
    """Simulate and return the recorded rows and the summary."""
    plan = scene_or_plan if isinstance(scene_or_plan, Plan) else make_plan(scene_or_plan)
    rows: list[list[float]] = []

    def keep(block: Array) -> None:
        rows.extend(block.tolist())

    ticks = iter(range(10))
    with BulletWorld(plan) as world:
        summary = run.run(plan, world, keep, steps, lambda: float(next(ticks)))
    return rows, summary


def columns_of(scene_or_plan: Scene | Plan, steps: int) -> dict[str, Array]:
    """Simulate and return the recorded columns by name, each of shape (rows,)."""
    plan = scene_or_plan if isinstance(scene_or_plan, Plan) else make_plan(scene_or_plan)
    rows = np.array(rows_of(plan, steps))
    return dict(zip(columns.header(plan.recorded), rows.T, strict=True))


def recorded_columns(data: Data, steps: int, **record: Any) -> dict[str, np.ndarray]:
    """Simulate a scene given as data, recording these, and return its columns by name."""
    pytest.importorskip("pybullet")
    return columns_of(scene_from_text(json.dumps({**data, "record": record})), steps)


def stacked_columns(found: dict[str, np.ndarray], *names: str) -> np.ndarray:
    """Return some columns side by side, shape (rows, names)."""
    return np.stack([found[name] for name in names], axis=1)


def estimated_errors(scene_or_plan: Scene | Plan, steps: int) -> ErrorEstimate:
    """Simulate, and return the estimated error of every column."""
    plan = scene_or_plan if isinstance(scene_or_plan, Plan) else make_plan(scene_or_plan)
    runner = LevelRunner(BulletWorld, lambda: 0.0, temporary_file)
    with temporary_file() as stream:
        spooled = runner.run(plan, steps, stream)
        assert runner.summary is not None
        return estimate(plan, spooled.reader, runner.summary.steps, runner)
