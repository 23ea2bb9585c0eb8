"""somo run --tolerance: the run that halves its step until it is known well enough."""

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING

from somo_cli import files, output_files, terminal
from somo_cli.budget import Budget
from somo_cli.cli import run_report
from somo_cli.cli.run_outputs import Targets, metadata_of, write_metadata

if TYPE_CHECKING:
    from somo_cli.analysis.refinement import Refinement
    from somo_cli.analysis.tolerances import Tolerances
    from somo_cli.api.runs import PreparedRun
    from somo_cli.simulation.run import RunSummary


def simulate_to_tolerance(
    prepared: "PreparedRun",
    steps: int,
    targets: Targets,
    sets: Sequence[str],
    tolerances: "Tolerances",
    max_halvings: int,
    quiet: bool,
    budget: Budget,
) -> "tuple[RunSummary, bool]":
    """Write the finest of the runs; return its summary, and whether it is within the tolerances.

    The files appear when all runs are done, so what is interrupted leaves none.
    """
    from somo_cli.analysis import refinement_report

    for target in targets:
        if target not in (None, "-"):
            output_files.refuse_unwritable(target)
    with ExitStack() as stack:
        found = _refined(prepared, steps, targets, tolerances, max_halvings, stack, budget)
        finest = replace(prepared, plan=found.plan)
        events = None if found.events is None else found.events[1]
        about = metadata_of(finest, found.summary, sets, targets[0], events)
        about["error"] = refinement_report.plain_error(found)
        about["refinement"] = refinement_report.plain_refinement(found)
        _write(finest, found, targets)
    write_metadata(targets[0], about)
    if not quiet:
        terminal.print_lines(run_report.summary_lines(finest, found.summary, targets, events))
    terminal.print_lines(run_report.finding_lines(found.summary))
    if not quiet or not found.is_converged:
        terminal.print_lines(refinement_report.refinement_lines(found))
    return found.summary, found.is_converged


def _refined(
    prepared: "PreparedRun",
    steps: int,
    targets: Targets,
    tolerances: "Tolerances",
    max_halvings: int,
    stack: ExitStack,
    budget: Budget,
) -> "Refinement":
    from somo_cli.analysis.refinement import Refiner
    from somo_cli.analysis.spooled_run import LevelRunner
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    most = steps // 2 + steps * (2 ** (max_halvings + 1) - 1)
    with stdout_to_stderr(), terminal.progress(most, "to the tolerance", budget) as advance:
        runner = LevelRunner(BulletWorld, time.perf_counter, files.temporary_file, advance)
        return Refiner(
            prepared.plan,
            steps,
            tolerances,
            runner,
            stack,
            max_halvings,
            with_events=targets[1] is not None,
        ).refine()


def _write(finest: "PreparedRun", found: "Refinement", targets: Targets) -> None:
    from somo_cli.simulation.recording.csv_writer import CsvWriter

    output, of_events = targets
    with output_files.open_partial(output) as stream:
        found.rows.write_to(CsvWriter(stream, finest.names).write)
    if of_events is not None and found.events is not None:
        with output_files.open_partial(of_events) as stream:
            stream.write(found.events[0])
