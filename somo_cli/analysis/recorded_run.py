"""A run of a plan in memory: its rows, or the run time of its stepping loop."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from somo_cli.analysis.impulses import RowsWithImpulses, sampled_plan
from somo_cli.arrays import Array
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.monitoring.contact_events import ContactEvent
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import run

OpenWorld: TypeAlias = Callable[[Plan], AbstractContextManager[World]]
"""Opens an engine for a plan."""

Clock: TypeAlias = Callable[[], float]
"""Returns the time since an arbitrary instant [s]."""


Advance: TypeAlias = Callable[[int], None]
"""Takes the steps done of a run, and may end it by an exception."""


def _go_on(done: int) -> None:
    pass


def record_rows(plan: Plan, steps: int, open_world: OpenWorld) -> Array:
    """Simulate and return the recorded rows, shape (rows, columns), time first, in SI.

    Raises SimulationDiverged and EngineRefused.
    """
    blocks: list[Array] = []
    with open_world(plan) as world:
        run(plan, world, blocks.append, steps, lambda: 0.0)
    return np.concatenate(blocks)


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """The rows of a run, shape (rows, columns with impulses), time first, in SI.

    `events` is how often two links began to press on each other, 0 where that was not counted.
    """

    rows: Array
    events: int = 0


def record_run(
    plan: Plan, steps: int, open_world: OpenWorld, advance: Advance = _go_on
) -> RecordedRun:
    """Simulate and return the recorded rows; contacts are counted where bodies can touch.

    Behind the columns are the impulses of the contact forces that are recorded [N·s]. Raises
    SimulationDiverged and EngineRefused.
    """
    blocks: list[Array] = []
    begun: list[int] = []

    def count(event: ContactEvent) -> None:
        if event.kind == "begin":
            begun.append(event.step)

    rows, sampled = RowsWithImpulses(plan, blocks.append), sampled_plan(plan)
    on_event = count if plan.can_touch else None
    with open_world(sampled) as world:
        run(sampled, world, rows.take, steps, lambda: 0.0, advance, on_event)
    rows.finish()
    return RecordedRun(np.concatenate(blocks), len(begun))


def median_run_time(
    plan: Plan,
    steps: int,
    open_world: OpenWorld,
    clock: Clock,
    repeats: int,
    advance: Advance = _go_on,
) -> float:
    """Return the run time of the stepping loop alone [s], the median of `repeats` runs.

    The runs record nothing but the time in the first and the last row. Raises SimulationDiverged
    and EngineRefused.
    """
    bare = replace(plan, columns=(), every=max(1, steps))
    times = []
    for repeat in range(repeats):

        def advance_within(step: int, before: int = repeat * steps) -> None:
            advance(before + step)

        with open_world(bare) as world:
            summary = run(bare, world, lambda rows: None, steps, clock, advance_within)
        times.append(summary.wall_time)
    return statistics.median(times)
