"""Runs of the loop in a fake world."""

from __future__ import annotations

from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import RunSummary, run
from tests.builders.fake_world import FakeWorld


class FakeRun:
    """One run, its rows and what it reported, whether it came to its end or not."""

    def __init__(self, plan: Plan, world: FakeWorld, steps: int) -> None:
        self.rows: list[list[float]] = []
        self.reported: list[int] = []
        self.summary: RunSummary | None = None
        self.error: SimulationDiverged | None = None
        ticks = iter([10.0, 12.5])

        def write(block: Array) -> None:
            self.rows.extend(block.tolist())

        try:
            self.summary = run(plan, world, write, steps, lambda: next(ticks), self.reported.append)
        except SimulationDiverged as error:
            self.error = error

    @property
    def times(self) -> list[float]:
        return [row[0] for row in self.rows]
