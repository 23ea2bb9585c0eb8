"""Scenes for tests and measurements, by the same stages as the command line."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from somo_cli.arrays import Array
from somo_cli.loading import load_text, scene_of
from somo_cli.scene.model import Scene
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import RunSummary

DEFINITIONS = Path(__file__).parents[1] / "definitions"


def scene_from_text(text: str, *sets: str, source: str = str(DEFINITIONS / "test.yaml")) -> Scene:
    """Read a scene, or a definition as the scene of it alone; paths are those of definitions/."""
    return scene_of(load_text(text, source, sets))[0]


def scene_from_file(name: str, *sets: str) -> Scene:
    """Read a scene of definitions/."""
    path = DEFINITIONS / name
    return scene_from_text(path.read_text("utf-8"), *sets, source=str(path))


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


def in_turn(rows: Sequence[Sequence[float]]) -> Callable[[int], Array]:
    """Return a function that gives the next so many rows."""
    left = iter(rows)
    return lambda count: np.array(list(itertools.islice(left, count)))
