"""A run of a plan in memory: its rows, or the run time of its stepping loop."""

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
"""Opens an engine for a plan."""

Clock: TypeAlias = Callable[[], float]
"""Returns the time since an arbitrary instant [s]."""


def record_rows(plan: Plan, steps: int, open_world: OpenWorld) -> Array:
    """Simulate and return the recorded rows, shape (rows, columns), time first, in SI.

    Raises SimulationDiverged and EngineRefused.
    """
    blocks: list[Array] = []
    with open_world(plan) as world:
        run(plan, world, blocks.append, steps, lambda: 0.0)
    return np.concatenate(blocks)


def median_run_time(
    plan: Plan, steps: int, open_world: OpenWorld, clock: Clock, repeats: int
) -> float:
    """Return the run time of the stepping loop alone [s], the median of `repeats` runs.

    The runs record nothing but the time in the first and the last row. Raises SimulationDiverged
    and EngineRefused.
    """
    bare = replace(plan, columns=(), every=max(1, steps))
    times = []
    for _ in range(repeats):
        with open_world(bare) as world:
            times.append(run(bare, world, lambda rows: None, steps, clock).wall_time)
    return statistics.median(times)
