"""somo report: measure error against run time."""

import json
import time
from collections.abc import Iterator, Sequence
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
from somo_cli.cli.simulated_time import check_time_options
from somo_cli.problems import ExtraMissing, InvalidFile, Problem

if TYPE_CHECKING:
    from somo_cli.analysis.common_instants import Instants
    from somo_cli.analysis.study_model import Study, StudySettings
    from somo_cli.document.parse import Document
    from somo_cli.scene.model import Integrator, Scene

DEFAULT_DURATION = 1.0  # s
INTEGRATORS = ("implicit", "euler", "explicit")


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
) -> None:
    """Measure error against run time, over time steps, integrators and numbers of segments.

    The table on standard output ends with a recommendation. Errors of positions, angles and energy
    are against the limit of the scene for vanishing time steps, or against the closed form that the
    scene names. Scenes with contact or objects have a second table: contact events, poses of
    objects, mean normal forces of pairs, and the worst of what the scene records, by which the step
    is then recommended. Run times are those of the stepping loop alone.
    """
    from somo_cli import document_kinds, loading
    from somo_cli.analysis import closed_form_references, study_export, study_report
    from somo_cli.analysis.recorded_report import recorded_table
    from somo_cli.analysis.study import total_steps
    from somo_cli.analysis.study_model import StudySettings
    from somo_cli.simulation.metadata import provenance

    budget = budget_of(max_seconds, max_memory)
    check_time_options(None, duration)
    require(0 < target < 1, "--target", f"{target} is not between 0 and 1")
    document = loading.load(scene, sets or [], *access_of(allow_outside, package))
    planned, warnings = loading.scene_of(document)
    terminal.print_problems(warnings, document.texts)
    document_kinds.refuse_without_manipulators(
        document, planned, "the report measures errors of tips; run --error measures objects"
    )
    loading.refuse_overlaps(document, planned)
    simulated = duration if duration is not None else planned.duration or DEFAULT_DURATION
    steps = _steps(time_steps, planned.time_step)
    settings = StudySettings(
        steps,
        _integrators(integrators),
        _counts(segments),
        _instants(steps, simulated),
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
    output_files.write_atomically(str(folder / "report.json"), json.dumps(about, indent=2) + "\n")
    output_files.write_atomically(str(folder / "report.csv"), study_export.csv_text(study))
    for kind, picture in pictures.items():
        output_files.write_atomically(str(folder / f"report.{kind}"), picture)
    typer.echo(study_report.table(study))
    typer.echo("")
    if contact := recorded_table(study):
        typer.echo(f"{contact}\n")
    for remark in study_report.remarks(study, target):
        typer.echo(remark)
    if not quiet:
        kinds = ", ".join(f"report.{kind}" for kind in ("csv", "json", *pictures))
        terminal.print_message(f"{folder}: {kinds}")


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


def _steps(text: str | None, own: float) -> tuple[float, ...]:
    from fractions import Fraction

    from somo_cli.analysis import common_instants

    if text is None:
        factors = (Fraction(4), Fraction(2), Fraction(1), Fraction(1, 2), Fraction(1, 4))
        return common_instants.scaled_steps(own, factors)
    try:
        steps = tuple(dict.fromkeys(float(part) for part in text.split(",")))
    except ValueError:
        raise typer.BadParameter(
            f"{text!r} is not a list of numbers, such as 0.001,0.002", param_hint="'--time-steps'"
        ) from None
    for step in steps:
        require(0 < step <= 1, "--time-steps", f"{step} is not greater than 0 and at most 1")
    return steps


def _integrators(text: str) -> tuple["Integrator", ...]:
    found: list[Integrator] = []
    for name in dict.fromkeys(text.split(",")):
        require(
            name in INTEGRATORS, "--integrators", f"{name!r} is not one of {', '.join(INTEGRATORS)}"
        )
        found.append(name)  # type: ignore[arg-type]
    return tuple(found)


def _counts(text: str | None) -> tuple[int | None, ...]:
    if text is None:
        return (None,)
    parts = text.split(",")
    for part in parts:
        is_count = part.isascii() and part.isdigit() and 0 < int(part) <= 121
        require(is_count, "--segments", f"{part!r} is not a number of segments, 1 to 121")
    return tuple(sorted({int(part) for part in parts}))


def _instants(steps: Sequence[float], duration: float) -> "Instants":
    from somo_cli.analysis import common_instants

    try:
        return common_instants.common_instants(steps, duration)
    except common_instants.NoCommonInstants as error:
        hint = "choose steps that are multiples of one another, or a longer --duration"
        raise typer.BadParameter(f"{error}; {hint}", param_hint="'--time-steps'") from error


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
