"""somo report: measure error against run time."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import output_files, terminal
from somo_cli.budget import Budget
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
    require_few_steps,
)
from somo_cli.cli.report_options import (
    INTEGRATORS,
    counts_of,
    instants_of,
    integrators_of,
    time_steps_of,
)
from somo_cli.cli.simulated_time import StepsOption, check_time_options, parse_steps
from somo_cli.problems import ExtraMissing, InvalidFile, Problem

if TYPE_CHECKING:
    from somo_cli.analysis.study_model import Study, StudySettings
    from somo_cli.document.parse import Document
    from somo_cli.scene.model import Scene

DEFAULT_DURATION = 1.0  # s


@app.command(
    short_help="Measure error against run time.",
    epilog=examples_of(
        "somo report scene.yaml --duration 0.5",
        "somo report scene.yaml --time-steps 0.004,0.002,0.001",
    ),
)
@report_errors
def report(
    scene: Annotated[str, typer.Argument(help="A scene, or a definition to run by itself.")],
    steps: StepsOption = None,
    duration: Annotated[
        float | None,
        typer.Option(
            "--duration",
            metavar="S",
            help="Simulated time in seconds. [default: that of the scene, else 1]",
        ),
    ] = None,
    time_steps: Annotated[
        str | None,
        typer.Option(
            "--time-steps",
            metavar="S,S,...",
            help="Time steps in seconds. [default: 4, 2, 1, 1/2 and 1/4 of the scene's]",
        ),
    ] = None,
    integrators: Annotated[
        str, typer.Option("--integrators", metavar="NAME,...", help="Integrators to compare.")
    ] = ",".join(INTEGRATORS),
    segments: Annotated[
        str | None,
        typer.Option(
            "--segments",
            metavar="N,N,...",
            help="Numbers of segments of every actuator, for the same continuum. [default: the "
            "scene's]",
        ),
    ] = None,
    target: Annotated[
        float,
        typer.Option(
            "--target",
            help="Target of the tip error, relative to the length; with contact or objects, "
            "of the errors of all that it records, over their ranges.",
        ),
    ] = 0.01,
    repeats: Annotated[
        int, typer.Option("--repeats", min=1, help="Number of runs for the median run time.")
    ] = 3,
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="DIR",
            help="Folder for report.csv, report.json and, with somo-cli[plot], report.png and "
            "report.svg. [default: the scene's name with _report, in the current directory]",
        ),
    ] = None,
    max_seconds: SecondsOption = None,
    max_memory: MemoryOption = None,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
    quiet: QuietOption = False,
    as_json: Annotated[
        bool,
        typer.Option("--json", help="Print report.json on standard output, not the tables."),
    ] = False,
) -> None:
    """Measure error against run time, over time steps, integrators and numbers of segments.

    The table on standard output ends with a recommendation. Errors of positions, angles and energy
    are against the limit of the scene for vanishing time steps, or against the closed form that the
    scene names. Scenes with contact or objects have a second table: contact events, poses of
    objects, mean normal forces of pairs, and the worst of what the scene records, by which the step
    is then recommended. Run times are those of the stepping loop alone.
    """
    from somo_cli import document_kinds, loading
    from somo_cli.analysis import closed_form_references, study_export
    from somo_cli.analysis.study import total_steps
    from somo_cli.analysis.study_model import StudySettings
    from somo_cli.simulation.metadata import provenance

    budget = budget_of(max_seconds, max_memory)
    check_time_options(steps, duration)
    require(0 < target < 1, "--target", f"{target} is not between 0 and 1")
    document = loading.load(scene, sets or [], *access_of(allow_outside, package))
    planned, warnings = loading.scene_of(document)
    terminal.print_problems(warnings, document.texts)
    document_kinds.refuse_without_manipulators(
        document, planned, "the report measures errors of tips; run --error measures objects"
    )
    loading.refuse_overlaps(document, planned)
    simulated = _simulated_time(steps, duration, planned)
    sizes = time_steps_of(time_steps, planned.time_step)
    settings = StudySettings(
        sizes,
        integrators_of(integrators),
        counts_of(segments),
        instants_of(sizes, simulated),
        repeats,
    )
    require_few_steps(total_steps(settings), "--duration")
    with _reference_of(document):
        closed_form_references.check_applicable(planned)
        study = _studied(planned, settings, budget)

    folder = Path(output or f"{Path(scene).stem}_report")
    pictures = _pictures(study, Path(scene).stem)
    folder.mkdir(parents=True, exist_ok=True)
    about = {**provenance(document.texts, sets or []), **study_export.plain_data(study, target)}
    text = json.dumps(about, indent=2)
    output_files.write_atomically(str(folder / "report.json"), text + "\n")
    output_files.write_atomically(str(folder / "report.csv"), study_export.csv_text(study))
    for kind, picture in pictures.items():
        output_files.write_atomically(str(folder / f"report.{kind}"), picture)
    typer.echo(text if as_json else "\n".join(_lines(study, target)))
    if not quiet:
        kinds = ", ".join(f"report.{kind}" for kind in ("csv", "json", *pictures))
        terminal.print_message(f"{folder}: {kinds}")


def _simulated_time(steps: str | None, duration: float | None, scene: "Scene") -> float:
    """Return the simulated time [s]; --steps counts steps of the scene."""
    number = parse_steps(steps)
    if number is not None:
        require(number > 0, "--steps", "a report needs at least one")
        return number * scene.time_step
    return duration if duration is not None else scene.duration or DEFAULT_DURATION


def _lines(study: "Study", target: float) -> Iterator[str]:
    from somo_cli.analysis import study_report
    from somo_cli.analysis.recorded_report import recorded_table

    yield f"{study_report.table(study)}\n"
    if contact := recorded_table(study):
        yield f"{contact}\n"
    yield from study_report.remarks(study, target)


@contextmanager
def _reference_of(document: "Document") -> Iterator[None]:
    """Return the scene's closed form; report one that does not describe the scene, at its line."""
    from somo_cli.analysis.reference_scene import ReferenceMismatch

    try:
        yield
    except ReferenceMismatch as error:
        name = document.at(("reference",))
        message = f"the closed form '{name}' does not describe this scene: {error}"
        hint = "leave reference out to measure errors against vanishing time steps"
        place = document.span(("reference",))
        raise InvalidFile([Problem(place, message, hint)], document.texts) from error


def _studied(scene: "Scene", settings: "StudySettings", budget: Budget) -> "Study":
    from somo_cli.analysis.study import study, total_steps
    from somo_cli.manipulator.resegmentation import NotUniform
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    try:
        total = total_steps(settings)
        with stdout_to_stderr(), terminal.progress(total, "measuring", budget) as advance:
            return study(scene, settings, BulletWorld, time.perf_counter, advance)
    except NotUniform as error:
        raise typer.BadParameter(str(error), param_hint="'--segments'") from error


def _pictures(study: "Study", title: str) -> dict[str, bytes]:
    from somo_cli.picture import work_precision

    try:
        return work_precision.draw(study, title)
    except ExtraMissing as error:
        terminal.print_message(f"somo: {error}")
        return {}
