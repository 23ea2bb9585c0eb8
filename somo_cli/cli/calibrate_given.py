"""somo calibrate: the joints that its options speak of, of a definition or of a few numbers."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from somo_cli import terminal
from somo_cli.cli.calibrate_result import require_targets
from somo_cli.cli.door import require

if TYPE_CHECKING:
    from somo_cli.calibration.levers import Levers
    from somo_cli.document.parse import Document
    from somo_cli.manipulator.definition import Definition, Placement


@dataclass(frozen=True, slots=True)
class Given:
    """The joints to calibrate: of a definition, or made from a few numbers.

    `made` gives the axis with other numbers of joints, differently placed.
    """

    levers: "Levers"
    made: "Callable[[int, Placement], Levers]"
    placement: "Placement"
    document: "Document | None" = None
    definition: "Definition | None" = None


@dataclass(frozen=True, slots=True)
class MadeOf:
    """The options that make joints without a definition: length [m], joints or places [m], ..."""

    length: float | None
    joints: int | None
    places: str | None
    axes: int
    about: str
    placement: str


def of_path(definition: str | None, patch: str | None) -> str | None:
    """Return the definition to read: the argument, else the one to patch."""
    is_one = (
        definition is None or patch is None or Path(definition).resolve() == Path(patch).resolve()
    )
    require(is_one, "--patch", f"it names another definition than {definition}: leave that out")
    return definition or patch


def given(
    path: str | None,
    actuator: int,
    axis: int,
    at: float | None,
    made_of: MadeOf,
    write: str | None,
    patch: str | None,
) -> Given:
    """Return the joints that the options speak of."""
    from somo_cli.calibration.levers import NoLevers

    try:
        if path is None:
            return _from_numbers(axis, at, made_of)
        known = _from_definition(path, actuator, axis, at)
        assert known.document is not None
        require_targets(known.document, write, patch)
        return known
    except NoLevers as error:
        raise typer.BadParameter(str(error), param_hint="'--axis'") from error


def _from_definition(path: str, actuator: int, axis: int, at: float | None) -> Given:
    from somo_cli import loading
    from somo_cli.calibration import levers
    from somo_cli.manipulator.compile import compile_definition

    document = loading.load(path)
    loading.refuse_scene(document)
    loading.refuse_assembly(document, "a calibration is")
    compiled = compile_definition(document)
    terminal.say_problems(compiled.warnings, document.texts)
    known = levers.of_definition(compiled.definition, actuator, axis, at)
    one = compiled.definition.actuators[actuator]
    axes = max(one.channels) + 1

    def made(count: int, placement: "Placement") -> "Levers":
        return levers.evenly_made(
            known.length, count, axes, axis, known.direction, placement, known.at
        )

    return Given(known, made, one.placement, document, compiled.definition)


def _from_numbers(axis: int, at: float | None, made_of: MadeOf) -> Given:
    from somo_cli.calibration import levers

    directions = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    about, axes, length, joints = made_of.about, made_of.axes, made_of.length, made_of.joints
    require(about in directions, "--about", f"{about!r} is not x, y or z")
    is_known = made_of.placement in ("uniform", "gauss")
    require(is_known, "--placement", f"{made_of.placement!r} is not uniform or gauss")
    if length is None or (joints is None) == (made_of.places is None):
        raise typer.BadParameter(
            "give a definition, or --length and --joints or --places", param_hint="'DEFINITION'"
        )
    require(0 < length < 1e6, "--length", f"{length} is not greater than 0 and less than 1e6")
    require(axis < axes, "--axis", f"axis {axis} is not one of {axes}: give --axes")
    where: Placement = "gauss" if made_of.placement == "gauss" else "uniform"

    def made(count: int, other: "Placement") -> "Levers":
        return levers.evenly_made(length, count, axes, axis, directions[about], other, at)

    if joints is not None:
        require(0 < joints <= 1000, "--joints", f"{joints} is not from 1 to 1000")
        return Given(made(joints, where), made, where)
    assert made_of.places is not None
    places = _places(made_of.places)
    return Given(levers.placed_at(length, places, directions[about], at), made, where)


def _places(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        message = f"{text!r} is not a list of places in metres, such as 0.01,0.03"
        raise typer.BadParameter(message, param_hint="'--places'") from None
