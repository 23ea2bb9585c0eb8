"""One run of a plan kept in memory, and the run time of its stepping loop."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import run

OpenWorld: TypeAlias = Callable[[Plan], AbstractContextManager[World]]
"""How a plan gets an engine of its own."""

Clock: TypeAlias = Callable[[], float]
"""Seconds from whenever."""


def record_rows(plan: Plan, steps: int, open_world: OpenWorld) -> Array:
    """Simulate and return every recorded row, shape (rows, columns), time [s] first, SI.

    Raises SimulationDiverged and EngineRefused.
    """
    blocks: list[Array] = []
    with open_world(plan) as world:
        run(plan, world, blocks.append, steps, lambda: 0.0)
    return np.concatenate(blocks)


def median_run_time(
    plan: Plan, steps: int, open_world: OpenWorld, clock: Clock, repeats: int
) -> float:
    """Return the time of the stepping loop alone [s], the median of several runs.

    Nothing but the first and the last row is recorded, and of them only the time. Raises
    SimulationDiverged and EngineRefused.
    """
    bare = replace(plan, columns=(), every=max(1, steps))
    times = []
    for _ in range(repeats):
        with open_world(bare) as world:
            times.append(run(bare, world, lambda rows: None, steps, clock).wall_time)
    return statistics.median(times)
