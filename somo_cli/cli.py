"""The front door: commands that read files, call one function per stage, write the product."""

import functools
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from somo_cli import __version__, files, terminal
from somo_cli.problems import (
    EngineMissing,
    EngineRefused,
    InvalidFile,
    Problem,
    SimulationDiverged,
    has_errors,
    in_reading_order,
)

if TYPE_CHECKING:
    from somo_cli.document.parse import Document
    from somo_cli.simulation.scene import Scene

EXIT_CODES = """Exit codes: 0 done; 1 a check found something; 2 wrong usage; 3 the definition or
scene is at fault; 4 the simulation diverged; 5 a file cannot be read or written, or the engine is
missing; 130 interrupted. A closed pipe ends a run quietly, with 0."""

app = typer.Typer(
    help="Simulate soft, continuum manipulators as chains of links and spring-dampers.",
    epilog=EXIT_CODES,
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

Command = TypeVar("Command", bound=Callable[..., None])
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Override one value, such as actuator_definitions[0].n_segments=20. Repeatable.",
    ),
]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="No summary on success.")]


def main() -> None:
    """Run the command line."""
    files.open_standard_streams()
    try:
        app()
    except KeyboardInterrupt:
        sys.exit(130)


def _ending(command: Command) -> Command:
    """Turn what went wrong into a message and an exit code; the only place that does."""

    @functools.wraps(command)
    def wrapped(*args: object, **kwargs: object) -> None:
        try:
            command(*args, **kwargs)
        except InvalidFile as error:
            terminal.say_problems(error.problems, error.texts)
            raise typer.Exit(3) from error
        except SimulationDiverged as error:
            terminal.say(f"somo: the simulation diverged at {error}")
            terminal.say(f"  hint: {error.hint}")
            raise typer.Exit(4) from error
        except EngineRefused as error:
            terminal.say(f"somo: {error}")
            raise typer.Exit(3) from error
        except EngineMissing as error:
            terminal.say(f"somo: {error}")
            raise typer.Exit(5) from error
        except BrokenPipeError as error:
            # the reader has seen enough; keep Python from flushing into the closed pipe at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            raise typer.Exit(0) from error
        except OSError as error:
            terminal.say(f"somo: {error.filename or 'output'}: {error.strerror or error}")
            raise typer.Exit(5) from error
        except KeyboardInterrupt as error:
            terminal.say("somo: interrupted")
            raise typer.Exit(130) from error

    return wrapped  # type: ignore[return-value]


def _say_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"somo {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version and leave.", callback=_say_version, is_eager=True
        ),
    ] = False,
) -> None:
    pass


@app.command(epilog=EXIT_CODES)
@_ending
def build(
    definition: Annotated[str, typer.Argument(help="A manipulator definition, YAML or JSON.")],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Where to write; - is standard output. [default: the definition's urdf_filename, "
            "else its own name with .urdf, in the current directory]",
        ),
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option(
            "--scale", metavar="X", help="Length factor, in place of the one in the file."
        ),
    ] = None,
    sets: SetOption = None,
    tip_frame: Annotated[
        str | None,
        typer.Option(
            "--tip-frame", metavar="NAME", help="Add a massless link of that name at the tip."
        ),
    ] = None,
    verify: Annotated[
        bool,
        typer.Option("--verify", help="Read the URDF back with another reader and compare."),
    ] = False,
    quiet: QuietOption = False,
) -> None:
    """Compile a manipulator definition into a scaled URDF."""
    from somo_cli import loading
    from somo_cli.manipulator.compile import compile_definition
    from somo_cli.manipulator.dimensions import Scale

    is_scale = scale is None or 0 < scale <= 1e6
    _require(is_scale, "--scale", f"{scale} is not greater than 0 and at most 1e6")
    is_name = tip_frame is None or _is_name(tip_frame)
    _require(is_name, "--tip-frame", f"{tip_frame!r} is not a safe name")
    document = loading.load(definition, sets or [])
    loading.refuse_scene(document)
    compiled = compile_definition(document)
    terminal.say_problems(compiled.warnings, document.texts)
    names = {link.name for link in compiled.chain.links}
    _require(tip_frame not in names, "--tip-frame", f"{tip_frame} is the name of a link already")
    own = compiled.scale or Scale()
    wanted = own if scale is None else Scale(scale, own.mass)
    text = compiled.urdf(wanted, tip_frame)
    if verify:
        from somo_cli.manipulator.verify import require_equal

        require_equal(text, compiled.scaled_chain(wanted))
    name = compiled.definition.urdf_filename or f"{Path(definition).stem}.urdf"
    _refuse_overwriting(document, output or name)
    if output == "-":
        with files.partial("-") as stream:
            stream.write(text)
        return
    files.write_whole(output or name, text)
    if not quiet:
        terminal.say(f"{output or name}: {compiled.described(wanted)}")


@app.command(epilog=EXIT_CODES)
@_ending
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
        float | None,
        typer.Option("--time-step", metavar="S", help="Time step in seconds."),
    ] = None,
    sets: SetOption = None,
    quiet: QuietOption = False,
) -> None:
    """Simulate a scene and stream its trajectory to CSV.

    Rows so far stay in FILE.partial when the run does not reach its end.
    """
    from somo_cli import loading

    is_step = time_step is None or 0 < time_step <= 1
    _require(is_step, "--time-step", f"{time_step} is not greater than 0 and at most 1")
    document = loading.load(scene, sets or [])
    planned, warnings = loading.scene_of(document, every, time_step)
    terminal.say_problems(warnings, document.texts)
    target = output or f"{Path(scene).stem}.csv"
    _refuse_overwriting(document, target)
    _simulate(planned, document, steps, target, sets or [], quiet)


@app.command(epilog=EXIT_CODES)
@_ending
def check(
    paths: Annotated[list[str], typer.Argument(metavar="FILE...", help="Definitions, scenes.")],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the findings as JSON on standard output.")
    ] = False,
) -> None:
    """Say everything that build and run would complain about, without an engine."""
    from somo_cli import loading

    found: list[Problem] = []
    texts: dict[str, str] = {}
    is_unreadable = False
    for path in paths:
        try:
            document = loading.load(path)
        except InvalidFile as error:
            found.extend(error.problems)
            texts.update(error.texts)
        except OSError as error:
            is_unreadable = True
            terminal.say(f"somo: {error.filename or path}: {error.strerror or error}")
        else:
            found.extend(loading.judged(document))
            texts.update(document.texts)
    found = list(in_reading_order(found, texts))
    if as_json:
        typer.echo(json.dumps([_plain(problem) for problem in found], indent=2))
    else:
        terminal.say_problems(found, texts)
    raise typer.Exit(5 if is_unreadable else int(has_errors(found)))


@app.command(epilog=EXIT_CODES)
@_ending
def examples(
    folder: Annotated[str, typer.Argument(help="A folder to make.")] = "somo-examples",
) -> None:
    """Copy the shipped definitions, scenes and schemas into a new folder."""
    for path in files.copy_examples(folder):
        typer.echo(path)


def _refuse_overwriting(document: "Document", output: str) -> None:
    target = Path(output)
    is_input = target.exists() and any(
        Path(source).exists() and target.samefile(source) for source in document.texts
    )
    _require(not is_input, "--output", f"{output} is what is read")


def _simulate(
    scene: "Scene",
    document: "Document",
    steps: int,
    output: str,
    sets: Sequence[str],
    quiet: bool,
) -> None:
    from somo_cli.simulation import columns
    from somo_cli.simulation.bullet import BulletWorld
    from somo_cli.simulation.metadata import metadata
    from somo_cli.simulation.plan import make_plan
    from somo_cli.simulation.recorder import CsvRecorder
    from somo_cli.simulation.run import run as simulate

    plan = make_plan(scene)
    names = columns.header(plan)
    try:
        # the output comes first: the world takes standard output away from the engine
        with (
            files.partial(output) as stream,
            BulletWorld(plan) as world,
            terminal.progress(steps, "simulating") as advance,
        ):
            recorder = CsvRecorder(stream, names, flush_rows=output == "-")
            summary = simulate(plan, world, recorder.write, steps, time.perf_counter, advance)
    except (SimulationDiverged, KeyboardInterrupt):
        if output != "-" and Path(f"{output}.partial").exists():
            terminal.say(f"somo: the rows so far are in {output}.partial")
        raise
    inputs = {
        source: text for source, text in document.texts.items() if not source.startswith("--set")
    }
    about = metadata(plan, summary, inputs, sets, names)
    if output != "-" and not files.is_direct(output):
        files.write_whole(_beside(output), json.dumps(about, indent=2) + "\n")
    if not quiet:
        target = "standard output" if output == "-" else output
        terminal.say(
            f"{target}: {summary.rows} rows of {len(names)} columns; "
            f"{steps * plan.time_step:g} s in {summary.wall_time:.3g} s, "
            f"{about['steps_per_second'] or 0:.0f} steps per second"
        )


def _beside(output: str) -> str:
    path = Path(output)
    stem = path.name.removesuffix(".csv")
    return str(path.with_name(f"{stem}.meta.json"))


def _plain(problem: Problem) -> dict[str, object]:
    span = problem.span
    return {
        "path": span.source,
        "line": span.line,
        "column": span.column,
        "severity": problem.severity,
        "message": problem.message,
        "hint": problem.hint,
    }


def _require(is_right: bool, option: str, message: str) -> None:
    if not is_right:
        raise typer.BadParameter(message, param_hint=f"'{option}'")


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier() and len(text) <= 64
