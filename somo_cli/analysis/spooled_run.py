"""A run whose rows are kept in a temporary file while they are passed on."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import BinaryIO, TypeAlias

from somo_cli.analysis.impulses import (
    RowsWithImpulses,
    sampled_plan,
    width_with_impulses,
    without_impulses,
)
from somo_cli.analysis.recorded_run import Clock, OpenWorld
from somo_cli.arrays import Array
from somo_cli.simulation.monitoring.contact_events import ContactEvent
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording.csv_writer import RowSpool
from somo_cli.simulation.run import RunSummary, run

ROWS_AT_ONCE = 256

OpenFile: TypeAlias = Callable[[], AbstractContextManager[BinaryIO]]
"""Opens a temporary file that is deleted when it is closed."""

ReadRows: TypeAlias = Callable[[int], Array]
"""Returns so many rows each time, the next ones; fewer at the end."""


class SpooledRun:
    """Keeps the rows of one run of a plan, with impulses behind them, in a binary stream.

    `plan` is the plan to run; it records every step where the impulses need that.
    """

    def __init__(self, plan: Plan, stream: BinaryIO) -> None:
        self.plan = sampled_plan(plan)
        self._own = plan
        self._spool = RowSpool(stream, width_with_impulses(plan))
        self._rows = RowsWithImpulses(plan, lambda rows: None)

    def through(self, write: Callable[[Array], None]) -> Callable[[Array], None]:
        """Return a function that keeps rows and passes those of the own plan on to `write`."""
        keep = self._spool.write_through(without_impulses(self._own, write))
        self._rows = RowsWithImpulses(self._own, keep)
        return self._rows.take

    def finish(self, summary: RunSummary) -> RunSummary:
        """Pass on the last row where it is still to come; return the summary with all rows."""
        self._rows.finish()
        return replace(summary, rows=self._rows.written)

    @property
    def last(self) -> Array:
        """The last row with impulses, shape (1, columns)."""
        assert self._rows.last is not None, "the start is recorded"
        return self._rows.last

    def reader(self) -> ReadRows:
        """Return a function that gives so many rows with impulses each time, the next ones."""
        return self._spool.reader()

    def write_to(self, write: Callable[[Array], None]) -> None:
        """Write the rows kept, without impulses, many at a time."""
        read, pass_on = self.reader(), without_impulses(self._own, write)
        while len(rows := read(ROWS_AT_ONCE)):
            pass_on(rows)


class LevelRunner:
    """Runs plans one after the other into temporary files, and adds up what they take."""

    def __init__(
        self,
        open_world: OpenWorld,
        clock: Clock,
        open_file: OpenFile,
        advance: Callable[[int], None] = lambda done: None,
    ) -> None:
        self.open_file = open_file
        self.run_time = 0.0
        """The run time of all stepping loops so far [s]."""
        self.summary: RunSummary | None = None
        """The summary of the last run that ended."""
        self.has_struck_limits = False
        """Whether joints struck their limits in any run."""
        self._open_world = open_world
        self._clock = clock
        self._advance = advance
        self._done = 0

    def run(
        self,
        plan: Plan,
        steps: int,
        stream: BinaryIO,
        on_event: Callable[[ContactEvent], None] | None = None,
    ) -> SpooledRun:
        """Run a plan into a stream. Raises SimulationDiverged and EngineRefused."""
        spooled = SpooledRun(plan, stream)
        done = self._done

        def advance(step: int) -> None:
            self._done = done + step
            self._advance(self._done)

        take = spooled.through(lambda rows: None)
        with self._open_world(spooled.plan) as world:
            summary = run(spooled.plan, world, take, steps, self._clock, advance, on_event)
        self.summary = spooled.finish(summary)
        self.run_time += summary.wall_time
        self.has_struck_limits |= summary.struck_limits
        return spooled
