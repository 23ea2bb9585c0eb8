"""The application, the options that commands share, and message and exit code of each error."""

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from somo_cli import __version__, files, terminal
from somo_cli.budget import Budget, most_memory
from somo_cli.problems import (
    BudgetSpent,
    ClusterFailed,
    EngineMissing,
    ExtraMissing,
    InvalidFile,
    SimulationDiverged,
    SomoError,
    Terminated,
)

if TYPE_CHECKING:
    from somo_cli.packages import Access

EXIT_CODES = "Exit codes: 0 success, 1 problems found, others: see somo help commands."

MAX_STEPS = 1e8
"""The most time steps of a picture or a report, whose number follows from a time: hours of work."""

app = typer.Typer(
    help="Simulate soft, continuum manipulators as chains of links and spring-dampers.",
    epilog=EXIT_CODES,
    context_settings={"help_option_names": ["-h", "--help"]},
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
        help="Override one value, such as 'actuator_definitions[0].n_segments=20'. Repeatable.",
    ),
]
OutsideOption = Annotated[
    bool,
    typer.Option(
        "--allow-outside",
        help="Also read definitions, trajectories, meshes and URDFs outside the folder of the "
        "file that names them.",
    ),
]
PackageOption = Annotated[
    list[str] | None,
    typer.Option(
        "--package",
        metavar="NAME=FOLDER",
        help="The folder of package://NAME/... and model://NAME/... in URDFs. Repeatable.",
    ),
]
SecondsOption = Annotated[
    float | None,
    typer.Option(
        "--max-seconds",
        metavar="S",
        min=0.0,
        help="End with 6 when the command has taken longer while it works step by step. "
        "[default: no bound]",
    ),
]
MemoryOption = Annotated[
    float | None,
    typer.Option(
        "--max-memory",
        metavar="MB",
        min=0.0,
        help="End with 6 when it has had more in memory. [default: no bound]",
    ),
]
QuietOption = Annotated[
    bool, typer.Option("--quiet", "-q", help="Print no summary; warnings stay.")
]


def examples_of(*lines: str) -> str:
    """Return the end of a help text: commands as they are typed, one a line, and exit codes."""
    # \b keeps the lines of a paragraph as they are
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines) + f"\n\n{EXIT_CODES}"


def main() -> None:
    """Run the command line; raises SystemExit with its code."""
    app(prog_name="somo")  # also with python -m: the completion of shells goes by this name


def report_errors(command: Command) -> Command:
    """Make a command report each error by a message and an exit code."""

    @functools.wraps(command)
    def wrapped(*args: object, **kwargs: object) -> None:
        try:
            command(*args, **kwargs)
        except (SomoError, OSError, KeyboardInterrupt) as error:
            raise typer.Exit(_reported(error)) from error

    return wrapped  # type: ignore[return-value]


def _reported(error: SomoError | OSError | KeyboardInterrupt) -> int:
    """Print the message of an error; return the exit code."""
    if isinstance(error, SomoError):
        return _reported_user_error(error)
    if isinstance(error, BrokenPipeError):
        files.drop_standard_output()
        return 0
    if isinstance(error, OSError):
        name = error.filename or "standard output"
        terminal.print_message(f"somo: {name}: {error.strerror or error}")
        return 5
    if isinstance(error, Terminated):
        terminal.print_message(f"somo: terminated by signal {error.number}")
        return 128 + error.number
    terminal.print_message("somo: interrupted")
    return 130


def _reported_user_error(error: SomoError) -> int:
    if isinstance(error, InvalidFile):
        terminal.print_problems(error.problems, error.texts)
        return 3
    if isinstance(error, SimulationDiverged):
        terminal.print_message(f"somo: the simulation diverged at {error}")
        terminal.print_message(f"  hint: {error.hint}")
        return 4
    terminal.print_message(f"somo: {error}")
    if isinstance(error, BudgetSpent):
        return 6
    is_outside = isinstance(error, ClusterFailed | EngineMissing | ExtraMissing)
    return 5 if is_outside else 3


def _print_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"somo {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version and exit.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    pass


def budget_of(max_seconds: float | None, max_memory: float | None) -> Budget:
    """Return a budget that starts now; exit with a usage error where memory cannot be measured."""
    is_known = max_memory is None or not math.isnan(most_memory())
    require(is_known, "--max-memory", "memory cannot be measured on this system")
    return Budget(max_seconds, max_memory)


def access_of(allow_outside: bool, package: list[str] | None) -> "Access":
    """Return which files may be read; exit with a usage error for a malformed --package."""
    from somo_cli import packages

    try:
        known = packages.read_packages(package or [])
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--package'") from None
    return packages.Access(allow_outside, known, announcer())


def announcer() -> Callable[[str], None]:
    """Return a function that prints a message the first time that it is given."""
    printed: set[str] = set()

    def announce(message: str) -> None:
        if message not in printed:
            printed.add(message)
            terminal.print_message(f"somo: {message}")

    return announce


def require_few_steps(steps: float, option: str) -> None:
    """Exit with a usage error for a time that takes more than `MAX_STEPS` time steps."""
    message = f"that takes {steps:.3g} time steps, more than {MAX_STEPS:.0e}: take a larger one"
    require(steps <= MAX_STEPS, option, message)


def require(is_right: bool, option: str, message: str) -> None:
    """Exit with a usage error about an option unless `is_right`."""
    if not is_right:
        raise typer.BadParameter(message, param_hint=f"'{option}'")
