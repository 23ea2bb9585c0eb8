"""somo run: simulate a scene and write its trajectory as CSV."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import (
    MemoryOption,
    OutsideOption,
    PackageOption,
    QuietOption,
    SecondsOption,
    SetOption,
    access_of,
    app,
    budget_of,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_unsafe
from somo_cli.cli.run_outputs import (
    outputs_of,
    target_of_events,
    with_columns,
)
from somo_cli.cli.simulated_time import (
    DurationOption,
    StepsOption,
    check_time_options,
    steps_to_take,
)

if TYPE_CHECKING:
    from somo_cli.analysis.tolerances import Tolerances
    from somo_cli.loading import Auto
    from somo_cli.scene.model import Scene


@app.command(
    short_help="Simulate a scene and write its trajectory as CSV.",
    epilog=examples_of(
        "somo run scene.yaml --duration 2.5 -o finger.csv",
        "somo run scene.yaml --duration 2.5 --tolerance 1e-2",
        "somo run scene.yaml --steps 500 --set 'manipulators[0].scale.length=10'",
    ),
)
@report_errors
def run(
    scene: Annotated[str, typer.Argument(help="A scene, or a definition to run by itself.")],
    steps: StepsOption = None,
    duration: DurationOption = None,
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
            "--explain",
            "--verbose",
            "-v",
            help="Print before the run what it skips, why, and what that saves.",
        ),
    ] = False,
    keeps_unused: Annotated[
        bool,
        typer.Option(
            "--keep-everything",
            help="Load shapes, solve constraints and read state that no result needs, as a check.",
        ),
    ] = False,
    is_guarded: Annotated[
        bool,
        typer.Option(
            "--guarded",
            help="Simulate in a process of its own: if the engine dies, exit with 4 and keep the "
            "rows so far.",
        ),
    ] = False,
    max_seconds: SecondsOption = None,
    max_memory: MemoryOption = None,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
    quiet: QuietOption = False,
) -> None:
    """Simulate a scene and write its trajectory as CSV.

    If the run does not reach its end, FILE.partial has the rows so far.
    """
    from somo_cli import loading

    budget = budget_of(max_seconds, max_memory)
    hint = "--tolerance tells the error as well: leave --error out"
    require(not (tolerance and with_error), "--error", hint)
    check_time_options(steps, duration)
    step = _step(time_step)
    document = loading.load(scene, sets or [], *access_of(allow_outside, package))
    planned, warnings = loading.scene_of(document, every, step)
    terminal.print_problems(warnings, document.texts)
    count = steps_to_take(steps, duration, planned)
    if record:
        planned = with_columns(planned, record)
    target = output or f"{Path(scene).stem}.csv"
    targets = target, target_of_events(planned, target, events)
    refuse_unsafe(document.texts, outputs_of(targets))
    if is_guarded:
        from somo_cli.cli.run_guarded import go_on_in_child

        go_on_in_child(scene, targets)
    from somo_cli.api import runs
    from somo_cli.simulation import plan_report

    prepared = runs.prepare(document, planned, warnings, keeps_unused)
    _warn_if_nothing_moves(planned)
    if explains:
        terminal.print_lines(map(str, plan_report.explain(prepared.plan)))
    is_known = True
    if tolerance:
        from somo_cli.cli.run_tolerance import simulate_to_tolerance

        allowed = _tolerances(tolerance, prepared.names)
        summary, is_known = simulate_to_tolerance(
            prepared, count, targets, sets or [], allowed, halvings, quiet, budget
        )
    else:
        from somo_cli.cli.run_once import simulate_once

        summary = simulate_once(prepared, count, targets, sets or [], with_error, quiet, budget)
    if not is_known or (is_strict and summary.findings):
        raise typer.Exit(1)


def _warn_if_nothing_moves(scene: "Scene") -> None:
    from somo_cli.simulation.stillness import HINT, why_nothing_moves

    why = why_nothing_moves(scene)
    if why is not None:
        terminal.print_lines([f"somo: warning: {why}", f"  hint: {HINT}"])


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
