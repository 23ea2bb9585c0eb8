"""Run a plan in a world from its start to its end, and write its rows."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.integrator.contact_prediction import PredictionCount
from somo_cli.simulation.monitoring.contact_events import ContactEvent
from somo_cli.simulation.monitoring.findings import Finding
from somo_cli.simulation.monitoring.penetration import Penetration
from somo_cli.simulation.monitoring.stop_monitor import StopMonitor, StopReason
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording.row_assembler import RowAssembler, RowWriter
from somo_cli.simulation.session import Session

MAX_LIVE_DELAY = 0.05  # s for which a row may wait, beyond the interval between two checks


@dataclass(frozen=True, slots=True)
class RunSummary:
    """The outcome of a run: steps done, rows written, and the wall time of the stepping loop [s].

    `stopped` is the stop condition that ended the run, None if it ran to its end. `deepest` is the
    deepest penetration, None if there was none. `findings` come from the contact monitors.
    """

    steps: int
    rows: int
    wall_time: float
    stopped: StopReason | None = None
    deepest: Penetration | None = None
    findings: tuple[Finding, ...] = ()
    prediction: PredictionCount = field(default_factory=PredictionCount)
    """The number of steps with contact, and of those in which it was not predicted."""
    struck_limits: bool = False
    """Whether a joint struck a limit that the integrator holds."""


@np.errstate(over="ignore", invalid="ignore")  # the divergence monitor reports both
def run(
    plan: Plan,
    world: World,
    write: RowWriter,
    steps: int,
    clock: Callable[[], float],
    advance: Callable[[int], None] = lambda done: None,
    on_event: Callable[[ContactEvent], None] | None = None,
    is_live: bool = False,
) -> RunSummary:
    """Simulate `steps` steps and write a row of SI values for each recorded step, start included.

    `write` takes many rows at once, shape (rows, columns); if `is_live`, soon after their step.
    With `on_event`, contacts are listed in every step, and each change is passed on. `advance`
    takes the number of steps done, for a progress bar. A stop condition of the plan can end the
    run early. However the run ends, the rows up to then are written. Raises SimulationDiverged.
    """
    session = Session(plan, world, write, on_event)
    assembler = session.assembler
    assert assembler is not None, "rows are written"
    stop_monitor = StopMonitor(plan, world, session.steppers, steps, session.findings)
    flusher = _Flusher(assembler, clock, is_live)
    stopped: StopReason | None = None
    started = clock()
    try:
        while True:
            session.actuate()
            session.monitor(is_last=session.step == stop_monitor.steps)
            advance(session.step)
            if session.schedule.checks_motion(session.step):
                assembler.count_rotations()
                stopped = stop_monitor.check(session.step)
                flusher.flush_if_due()
            if stopped is not None or session.step >= stop_monitor.steps:
                break
            session.advance(session.schedule.pause_after(session.step, stop_monitor.steps))
        if session.step % plan.every == 0 or plan.records_last_step:
            session.record_last()
    except BaseException:
        with suppress(OSError):  # a full disk must not hide what ended the run
            assembler.flush()
        raise
    assembler.flush()
    return RunSummary(
        session.step,
        assembler.written,
        clock() - started,
        stopped or stop_monitor.at_step(session.step),
        session.deepest,
        session.findings(),
        session.prediction_count,
        any(one.limits.were_struck for one in session.steppers),
    )


class _Flusher:
    """Writes rows when the buffer is full or, in a live run, when they have waited too long."""

    def __init__(self, assembler: RowAssembler, clock: Callable[[], float], is_live: bool) -> None:
        self._assembler = assembler
        self._clock = clock
        self._is_live = is_live
        self._flushed = clock() if is_live else 0.0

    def flush_if_due(self) -> None:
        is_late = self._is_live and self._clock() - self._flushed > MAX_LIVE_DELAY
        if self._assembler.is_full or is_late:
            self._assembler.flush()
            if self._is_live:
                self._flushed = self._clock()
