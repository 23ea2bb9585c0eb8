"""The options that say how long a scene is simulated, the same in every command."""

from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import require

if TYPE_CHECKING:
    from somo_cli.scene.model import Scene

MAX_DURATION = 1e6
"""The longest simulated time [s]."""

StepsOption = Annotated[
    str | None,
    typer.Option(
        "--steps", metavar="N", help="Number of time steps, such as 2000 or 2e3, or --duration."
    ),
]
DurationOption = Annotated[
    float | None,
    typer.Option(
        "--duration",
        metavar="S",
        help="Simulated time in seconds, in place of --steps. [default: that of the scene]",
    ),
]


def parse_steps(text: str | None) -> int | None:
    """Return a number of steps; exit with a usage error for text that is none."""
    if text is None:
        return None
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    is_right = 0 <= number <= 1e15 and number == int(number)
    require(is_right, "--steps", f"{text!r} is not a whole number from 0 on, such as 2000 or 2e3")
    return int(number)


def check_time_options(steps: str | None, duration: float | None) -> None:
    """Exit with a usage error for options that are wrong whatever the scene is."""
    parse_steps(steps)
    require(steps is None or duration is None, "--duration", "it excludes --steps")
    if duration is not None:
        message = f"{duration} is not greater than 0 and at most {MAX_DURATION:g}"
        require(0 < duration <= MAX_DURATION, "--duration", message)


def steps_to_take(steps: str | None, duration: float | None, scene: "Scene") -> int:
    """Return the number of time steps of a run of a scene.

    `--steps` or `--duration` says it, else the duration of the scene; exits with a usage error if
    none does. Says so where a time is not a whole number of steps.
    """
    from somo_cli.scene.duration import is_whole, steps_of

    number = parse_steps(steps)
    if number is not None:
        return number
    asked = duration if duration is not None else scene.duration
    if asked is None:
        raise typer.BadParameter(
            "give --duration in seconds, or --steps: the scene has no duration of its own",
            param_hint="'--duration'",
        )
    number = steps_of(asked, scene.time_step)
    if not is_whole(asked, scene.time_step):
        done = number * scene.time_step
        terminal.print_message(
            f"somo: {asked:g} s is not a whole number of steps of {scene.time_step:g} s: "
            f"simulating {number} steps, {done:.9g} s"
        )
    return number
