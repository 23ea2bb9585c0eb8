"""Halve the step of a scene until every column is known well enough."""

from __future__ import annotations

import io
import math
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Literal

import numpy as np

from somo_cli.analysis.error_estimate import (
    CONVERGENCE_ORDER,
    ColumnError,
    coarser_plan,
    errors_of_finer_run,
    finer_plan,
)
from somo_cli.analysis.level_comparison import LevelRows, QuaternionAlignment, compare
from somo_cli.analysis.observed_order import ObservedOrder
from somo_cli.analysis.outcomes import Outcomes, outcomes
from somo_cli.analysis.spooled_run import LevelRunner, SpooledRun
from somo_cli.analysis.tolerances import Tolerances
from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording.contact_event_writer import ContactEventWriter
from somo_cli.simulation.run import RunSummary

MAX_HALVINGS = 6


@dataclass(frozen=True, slots=True)
class LevelReport:
    """What one run cost [s], and how far off it is; no errors if there was no run to compare."""

    time_step: float
    run_time: float
    status: Literal["ok", "diverged"] = "ok"
    worst: ColumnError | None = None
    excess: float = math.nan


@dataclass(frozen=True, slots=True)
class Refinement:
    """The finest run of a scene and its errors; `halvings` is how often the step was halved.

    `events` is the text of its contact events, and their number, if they were asked for.
    """

    plan: Plan
    summary: RunSummary
    rows: SpooledRun
    errors: tuple[ColumnError, ...]
    tolerances: Tolerances
    halvings: int
    levels: tuple[LevelReport, ...]
    outcomes: Outcomes | None = None
    events: tuple[str, int] | None = None

    @property
    def agrees(self) -> bool:
        """Whether there are errors, and each is within its tolerance."""
        return self.tolerances.are_met(self.errors)

    @property
    def is_confirmed(self) -> bool:
        """Whether the outcome is that of three runs, if any run had another."""
        steps = [one.time_step for one in self.levels]
        return self.outcomes is None or not self.outcomes.parts_last_of_three(steps)

    @property
    def is_converged(self) -> bool:
        """Whether each error is within its tolerance, and the outcome is confirmed."""
        return self.agrees and self.is_confirmed

    @property
    def run_time(self) -> float:
        """The run time of all runs together [s]."""
        return sum(level.run_time for level in self.levels)


@dataclass(frozen=True, slots=True)
class _Level:
    """A run and the plan that it was of; it has every `stride`-th of the rows of the scene."""

    plan: Plan
    rows: SpooledRun
    summary: RunSummary
    stride: int
    events: tuple[str, int] | None


class Refiner:
    """Runs a plan at twice its step, at its own, at half of it and so on.

    The run at twice the step tells the order together with the next two. A coarse run that diverges
    is left out. Where the last two runs agree but the one before had another outcome, one more has
    to confirm theirs. Rows are at the instants of the plan's own. Temporary files live as long as
    `stack`.
    """

    def __init__(
        self,
        plan: Plan,
        steps: int,
        tolerances: Tolerances,
        runner: LevelRunner,
        stack: ExitStack,
        max_halvings: int = MAX_HALVINGS,
        with_events: bool = False,
    ) -> None:
        self._plan = plan
        self._steps = steps
        self._tolerances = tolerances
        self._runner = runner
        self._stack = stack
        self._max_halvings = max_halvings
        self._with_events = with_events
        self._levels: list[_Level] = []
        self._reports: list[LevelReport] = []
        self._ends: list[tuple[float, Array]] = []

    def refine(self) -> Refinement:
        """Return the finest run. Raises EngineRefused, and SimulationDiverged if that diverges."""
        for halvings in range(-1, self._max_halvings):
            errors = self._errors_at(halvings)
            if halvings < 1 or not errors:
                continue  # the scene's own step is compared with half of it
            found = self._refinement(errors, halvings)
            if found.is_converged:
                return found
        return self._refinement(self._errors_at(self._max_halvings), self._max_halvings)

    def _refinement(self, errors: tuple[ColumnError, ...], halvings: int) -> Refinement:
        finest = self._levels[-1]
        return Refinement(
            finest.plan,
            finest.summary,
            finest.rows,
            errors,
            self._tolerances,
            halvings,
            tuple(self._reports),
            self._outcomes(errors),
            finest.events,
        )

    def _outcomes(self, errors: tuple[ColumnError, ...]) -> Outcomes | None:
        """Return the outcomes of all runs that ended at the instant at which the finest did."""
        last = self._ends[-1][1]
        align, width = QuaternionAlignment(self._plan), len(errors) + 1
        same = [(step, row) for step, row in self._ends if math.isclose(row[0, 0], last[0, 0])]
        rows = np.array([align(row, last)[0, 1:width] for _, row in same])
        asked = [place for place, one in enumerate(errors) if self._tolerances.judges(one)]
        steps = [step for step, _ in same]
        return outcomes([errors[place] for place in asked], steps, rows[:, asked])

    def _errors_at(self, halvings: int) -> tuple[ColumnError, ...]:
        """Run a level and return its errors; none if there is no coarser run to compare it with."""
        plan, stride = (
            coarser_plan(self._plan) if halvings < 0 else (finer_plan(self._plan, 2**halvings), 1)
        )
        steps = self._steps // 2 if halvings < 0 else self._steps * 2**halvings
        before = self._runner.run_time
        try:
            level = self._run(plan, steps, stride)
        except SimulationDiverged:
            if halvings == self._max_halvings:
                raise
            self._levels.clear()
            cost = self._runner.run_time - before
            self._reports.append(LevelReport(plan.time_step, cost, "diverged"))
            return ()
        self._levels = [*self._levels[-2:], level]
        self._ends.append((plan.time_step, level.rows.last))
        errors = self._compared() if halvings > 0 else ()
        worst = max(errors, key=self._tolerances.excess, default=None)
        excess = math.nan if worst is None else self._tolerances.excess(worst)
        cost = self._runner.run_time - before
        self._reports.append(LevelReport(plan.time_step, cost, "ok", worst, excess))
        return errors

    def _run(self, plan: Plan, steps: int, stride: int) -> _Level:
        stream = self._stack.enter_context(self._runner.open_file())
        text = io.StringIO() if self._with_events else None
        writer = None if text is None else ContactEventWriter(text, plan)
        rows = self._runner.run(plan, steps, stream, None if writer is None else writer.write)
        summary = self._runner.summary
        assert summary is not None, "the run has ended"
        events = None if text is None or writer is None else (text.getvalue(), writer.events)
        return _Level(plan, rows, summary, stride, events)

    def _compared(self) -> tuple[ColumnError, ...]:
        if len(self._levels) < 2:
            return ()
        nominal = CONVERGENCE_ORDER[self._plan.integrator]
        levels = [LevelRows(one.rows.reader(), one.stride) for one in self._levels]
        last = len(levels) - 1
        found, order = compare(self._plan, levels, (last - 1, last))
        if found is None:
            return ()
        unknown = ObservedOrder(
            math.nan, nominal, is_irregular=True, is_striking=self._runner.has_struck_limits
        )
        return errors_of_finer_run(self._plan, found, order, unknown)
