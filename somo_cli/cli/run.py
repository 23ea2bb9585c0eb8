"""somo run: simulate a scene and write its trajectory as CSV."""

import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, BinaryIO

import typer

from somo_cli import files, output_files, terminal
from somo_cli.cli import run_report
from somo_cli.cli.application import (
    EXIT_CODES,
    OutsideOption,
    PackageOption,
    QuietOption,
    SetOption,
    access_of,
    app,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_unsafe
from somo_cli.cli.run_outputs import (
    Targets,
    outputs_of,
    target_of_events,
    with_columns,
    write_metadata,
)
from somo_cli.problems import SimulationDiverged

if TYPE_CHECKING:
    from somo_cli.analysis.error_estimate import ErrorEstimate
    from somo_cli.analysis.spooled_run import SpooledRun
    from somo_cli.analysis.tolerances import Tolerances
    from somo_cli.api.runs import PreparedRun
    from somo_cli.loading import Auto
    from somo_cli.simulation.plan.model import Plan
    from somo_cli.simulation.run import RunSummary


@app.command(epilog=EXIT_CODES)
@report_errors
def run(
    scene: Annotated[str, typer.Argument(help="A scene, or a definition to run by itself.")],
    steps: Annotated[int, typer.Option("--steps", min=0, help="Number of time steps.")],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Where to write the CSV; - is standard output. [default: the scene's name with "
            ".csv, in the current directory]",
        ),
    ] = None,
    every: Annotated[
        int | None, typer.Option("--every", min=1, help="Steps between two recorded rows.")
    ] = None,
    time_step: Annotated[
        str | None,
        typer.Option(
            "--time-step",
            metavar="S",
            help="Time step in seconds, or auto: the one that check --numerics recommends.",
        ),
    ] = None,
    with_error: Annotated[
        bool,
        typer.Option(
            "--error",
            help="Run again at half and at twice the step, and say how far off the columns are, "
            "and whether the run is converged.",
        ),
    ] = False,
    tolerance: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance",
            metavar="SHARE|COLUMN=VALUE",
            help="Halve the step until the estimated error of every column is below this share of "
            "its range, such as 1e-2, or of the columns that match a pattern, in their unit, such "
            "as 'cube.pose.*_m=1e-4'; write the finest run. Exits with 1 if that does not "
            "succeed. Repeatable.",
        ),
    ] = None,
    halvings: Annotated[
        int,
        typer.Option("--halvings", min=1, max=20, help="Most halvings of the step."),
    ] = 6,
    record: Annotated[
        list[str] | None,
        typer.Option(
            "--record",
            metavar="PATTERN",
            help="Record only the columns whose name matches, such as 'finger.tip.*', "
            "whatever the scene records. Repeatable.",
        ),
    ] = None,
    is_strict: Annotated[
        bool,
        typer.Option(
            "--strict",
            help="Exit with 1 if the run finds that contact did what no rigid body does: a force "
            "that shakes, contact lost or missed, energy gained, bodies deep in each other.",
        ),
    ] = False,
    events: Annotated[
        str | None,
        typer.Option(
            "--events",
            metavar="FILE",
            help="Where to write contact events as CSV; - is standard output.",
        ),
    ] = None,
    explains: Annotated[
        bool,
        typer.Option(
            "--explain", help="Print before the run what it skips, why, and what that saves."
        ),
    ] = False,
    keeps_unused: Annotated[
        bool,
        typer.Option(
            "--keep-everything",
            help="Load shapes, solve constraints and read state that no result needs, as a check.",
        ),
    ] = False,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
    quiet: QuietOption = False,
) -> None:
    """Simulate a scene and write its trajectory as CSV.

    If the run does not reach its end, FILE.partial has the rows so far.
    """
    from somo_cli import loading

    hint = "--tolerance tells the error as well: leave --error out"
    require(not (tolerance and with_error), "--error", hint)
    step = _step(time_step)
    document = loading.load(scene, sets or [], *access_of(allow_outside, package))
    planned, warnings = loading.scene_of(document, every, step)
    terminal.print_problems(warnings, document.texts)
    if record:
        planned = with_columns(planned, record)
    target = output or f"{Path(scene).stem}.csv"
    targets = target, target_of_events(planned, target, events)
    refuse_unsafe(document.texts, outputs_of(targets))
    from somo_cli.api import runs
    from somo_cli.simulation import plan_report

    prepared = runs.prepare(document, planned, warnings, keeps_unused)
    if explains:
        terminal.print_lines(map(str, plan_report.explain(prepared.plan)))
    is_known = True
    if tolerance:
        from somo_cli.cli.run_tolerance import simulate_to_tolerance

        allowed = _tolerances(tolerance, prepared.names)
        summary, is_known = simulate_to_tolerance(
            prepared, steps, targets, sets or [], allowed, halvings, quiet
        )
    else:
        summary = _simulate(prepared, steps, targets, sets or [], with_error, quiet)
    if not is_known or (is_strict and summary.findings):
        raise typer.Exit(1)


def _tolerances(texts: Sequence[str], names: Sequence[str]) -> "Tolerances":
    from somo_cli.analysis.tolerances import read_tolerances

    try:
        return read_tolerances(texts, names[1:])
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--tolerance'") from None


def _step(text: str | None) -> "float | Auto | None":
    if text is None:
        return None
    if text == "auto":
        return "auto"
    try:
        step = float(text)
    except ValueError:
        raise typer.BadParameter(
            f"{text!r} is neither a number nor auto", param_hint="'--time-step'"
        ) from None
    require(0 < step <= 1, "--time-step", f"{text} is not greater than 0 and at most 1")
    return step


def _simulate(
    prepared: "PreparedRun",
    steps: int,
    targets: Targets,
    sets: Sequence[str],
    with_error: bool,
    quiet: bool,
) -> "RunSummary":
    output, _ = targets
    lines: list[str] = []
    failure: SimulationDiverged | None = None
    with files.temporary_file() if with_error else nullcontext() as kept:
        spooled = None if kept is None else _spooled(prepared.plan, kept)
        summary, events = _recorded(prepared, steps, targets, spooled)
        about = prepared.metadata(summary, sets)
        about["scene"] = files.relative_path(prepared.document.source, output)
        if events is not None:
            about["events"] = events
        if spooled is not None:
            from somo_cli.analysis import error_report

            try:
                estimate = _estimated(prepared.plan, spooled, summary.steps)
                about["error"] = error_report.plain_estimate(estimate)
                lines = error_report.estimate_lines(estimate)
            except SimulationDiverged as error:
                about["error"], failure = None, error
    write_metadata(output, about)
    if not quiet:
        terminal.print_lines(run_report.summary_lines(prepared, summary, targets, events))
    for line in run_report.finding_lines(summary):
        terminal.print_message(line)
    terminal.print_lines(lines)
    if failure is not None:
        terminal.print_message("somo: there is no estimate of the error: at a smaller step")
        raise failure
    return summary


def _recorded(
    prepared: "PreparedRun", steps: int, targets: Targets, spooled: "SpooledRun | None"
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
            terminal.progress(steps, "simulating") as advance,
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
    except (SimulationDiverged, KeyboardInterrupt):
        for target in targets:
            if target not in (None, "-") and Path(f"{target}.partial").exists():
                terminal.print_message(f"somo: the rows so far are in {target}.partial")
        raise


def _spooled(plan: "Plan", stream: BinaryIO) -> "SpooledRun":
    from somo_cli.analysis.spooled_run import SpooledRun

    return SpooledRun(plan, stream)


def _estimated(plan: "Plan", spooled: "SpooledRun", steps: int) -> "ErrorEstimate":
    from somo_cli.analysis.error_estimate import estimate
    from somo_cli.analysis.spooled_run import LevelRunner
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    total = 2 * steps + steps // 2
    with stdout_to_stderr(), terminal.progress(total, "at other steps") as advance:
        runner = LevelRunner(BulletWorld, time.perf_counter, files.temporary_file, advance)
        return estimate(plan, spooled.reader, steps, runner)
