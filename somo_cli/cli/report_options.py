"""The lists among the options of somo report: time steps, integrators, numbers of segments.

Each function exits with a usage error for a list that cannot be read.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from somo_cli.cli.application import require

if TYPE_CHECKING:
    from somo_cli.analysis.common_instants import Instants
    from somo_cli.scene.model import Integrator

INTEGRATORS = ("implicit", "euler", "explicit")


def time_steps_of(text: str | None, own: float) -> tuple[float, ...]:
    """Return the time steps of `--time-steps` [s], else five around that of the scene."""
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


def integrators_of(text: str) -> tuple["Integrator", ...]:
    """Return the integrators of `--integrators`, each once."""
    found: list[Integrator] = []
    for name in dict.fromkeys(text.split(",")):
        require(
            name in INTEGRATORS, "--integrators", f"{name!r} is not one of {', '.join(INTEGRATORS)}"
        )
        found.append(name)  # type: ignore[arg-type]
    return tuple(found)


def counts_of(text: str | None) -> tuple[int | None, ...]:
    """Return the numbers of segments of `--segments`; None stands for those of the definition."""
    if text is None:
        return (None,)
    parts = text.split(",")
    for part in parts:
        is_count = part.isascii() and part.isdigit() and 0 < int(part) <= 121
        require(is_count, "--segments", f"{part!r} is not a number of segments, 1 to 121")
    return tuple(sorted({int(part) for part in parts}))


def instants_of(steps: Sequence[float], duration: float) -> "Instants":
    """Return the instants that runs at all these steps [s] have in common."""
    from somo_cli.analysis import common_instants

    try:
        return common_instants.common_instants(steps, duration)
    except common_instants.NoCommonInstants as error:
        hint = "choose steps that are multiples of one another, or a longer --duration"
        raise typer.BadParameter(f"{error}; {hint}", param_hint="'--time-steps'") from error
