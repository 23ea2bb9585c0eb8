"""A run at one time step: its rows, events, metadata and summary, and its error if asked."""

import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from somo_cli import files, output_files, terminal
from somo_cli.budget import Budget
from somo_cli.cli import run_report
from somo_cli.cli.run_outputs import Targets, metadata_of, write_metadata
from somo_cli.problems import BudgetSpent, SimulationDiverged

if TYPE_CHECKING:
    from somo_cli.analysis.error_estimate import ErrorEstimate
    from somo_cli.analysis.spooled_run import SpooledRun
    from somo_cli.api.runs import PreparedRun
    from somo_cli.simulation.plan.model import Plan
    from somo_cli.simulation.run import RunSummary


def simulate_once(
    prepared: "PreparedRun",
    steps: int,
    targets: Targets,
    sets: Sequence[str],
    with_error: bool,
    quiet: bool,
    budget: Budget,
) -> "RunSummary":
    """Simulate, write every file and print the summary.

    Raises SimulationDiverged, also if only a run at another step diverged that an error needs.
    """
    output, _ = targets
    lines: list[str] = []
    failure: SimulationDiverged | None = None
    with files.temporary_file() if with_error else nullcontext() as kept:
        spooled = None if kept is None else _spooled(prepared.plan, kept)
        summary, events = _recorded(prepared, steps, targets, spooled, budget)
        about = metadata_of(prepared, summary, sets, output, events)
        if spooled is not None:
            from somo_cli.analysis import error_report

            try:
                estimate = _estimated(prepared.plan, spooled, summary.steps, budget)
                about["error"] = error_report.plain_estimate(estimate)
                lines = error_report.estimate_lines(estimate)
            except SimulationDiverged as error:
                about["error"], failure = None, error
    write_metadata(output, about)
    if not quiet:
        terminal.print_lines(run_report.summary_lines(prepared, summary, targets, events))
    terminal.print_lines(run_report.finding_lines(summary))
    terminal.print_lines(lines)
    if failure is not None:
        terminal.print_message("somo: there is no estimate of the error: at a smaller step")
        raise failure
    return summary


def _recorded(
    prepared: "PreparedRun",
    steps: int,
    targets: Targets,
    spooled: "SpooledRun | None",
    budget: Budget,
) -> "tuple[RunSummary, int | None]":
    """Simulate and write the files; return a summary and, if events are recorded, their number."""
    from somo_cli.api import runs
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.recording.contact_event_writer import ContactEventWriter
    from somo_cli.simulation.recording.csv_writer import CsvWriter

    output, of_events = targets
    is_live = output == "-"
    try:
        # the outputs are opened first: then what the engine prints cannot reach standard output
        with (
            output_files.open_partial(output) as stream,
            nullcontext()
            if of_events is None
            else output_files.open_partial(of_events) as event_stream,
            stdout_to_stderr(),
            runs.OpenRun(prepared.plan if spooled is None else spooled.plan) as opened,
            terminal.progress(steps, "simulating", budget) as advance,
        ):
            writer = CsvWriter(stream, prepared.names, is_live=is_live)
            events = (
                None if event_stream is None else ContactEventWriter(event_stream, prepared.plan)
            )
            on_event = None if events is None else events.write
            take = writer.write if spooled is None else spooled.through(writer.write)
            summary = opened.run(steps, take, advance, on_event, is_live)
            if spooled is not None:
                summary = spooled.finish(summary)
            return summary, None if events is None else events.events
    except (SimulationDiverged, BudgetSpent, KeyboardInterrupt):
        for target in targets:
            if target not in (None, "-") and Path(f"{target}.partial").exists():
                terminal.print_message(f"somo: the rows so far are in {target}.partial")
        raise


def _spooled(plan: "Plan", stream: BinaryIO) -> "SpooledRun":
    from somo_cli.analysis.spooled_run import SpooledRun

    return SpooledRun(plan, stream)


def _estimated(plan: "Plan", spooled: "SpooledRun", steps: int, budget: Budget) -> "ErrorEstimate":
    from somo_cli.analysis.error_estimate import estimate
    from somo_cli.analysis.spooled_run import LevelRunner
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    total = 2 * steps + steps // 2
    with stdout_to_stderr(), terminal.progress(total, "at other steps", budget) as advance:
        runner = LevelRunner(BulletWorld, time.perf_counter, files.temporary_file, advance)
        return estimate(plan, spooled.reader, steps, runner)
