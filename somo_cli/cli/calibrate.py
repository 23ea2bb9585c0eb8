"""somo calibrate: what its commands share: whose joints, and where a result goes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from somo_cli import files, terminal
from somo_cli.cli.door import EXIT_CODES, app, require

if TYPE_CHECKING:
    from somo_cli.calibration.levers import Levers
    from somo_cli.document.parse import Document
    from somo_cli.document.table import Table
    from somo_cli.manipulator.definition import Definition, Placement
    from somo_cli.problems import Pointer

LARGEST_TABLE = 50_000_000
"""The most that a recording may hold [bytes]."""

calibrate = typer.Typer(
    help="From what a lab measures to joint stiffness, torque and damping.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.add_typer(calibrate, name="calibrate")

DefinitionArgument = Annotated[
    str | None,
    typer.Argument(
        help="A definition, whose joints are calibrated as they lie. [default: that of --patch, "
        "else joints by --length, --joints, ...]",
        show_default=False,
    ),
]
ActuatorOption = Annotated[
    int, typer.Option("--actuator", min=0, help="Number of the actuator, 0 at the base.")
]
AxisOption = Annotated[
    int,
    typer.Option(
        "--axis", min=0, help="Number of the axis: place in joint_definitions; 0 if planar."
    ),
]
AtOption = Annotated[
    float | None,
    typer.Option(
        "--at",
        metavar="M",
        help="Where the force is measured, from the base of the actuator [m]. [default: its end]",
    ),
]
LengthOption = Annotated[
    float | None, typer.Option("--length", metavar="M", help="Length of the actuator [m].")
]
JointsOption = Annotated[
    int | None, typer.Option("--joints", metavar="N", help="Number of joints of the axis.")
]
PlacesOption = Annotated[
    str | None,
    typer.Option(
        "--places",
        metavar="M,M,...",
        help="Where the joints of the axis are, from the base [m], in place of --joints.",
    ),
]
AxesOption = Annotated[
    int, typer.Option("--axes", min=1, max=3, help="Number of axes that take turns.")
]
AboutOption = Annotated[
    str, typer.Option("--about", metavar="x|y|z", help="Direction of the axis; z twists.")
]
PlacementOption = Annotated[
    str,
    typer.Option("--placement", metavar="uniform|gauss", help="Where the joints stand."),
]
WriteOption = Annotated[
    str | None,
    typer.Option(
        "--write",
        metavar="FILE",
        help="Write YAML with the result: a copy of the definition, else a piece of one.",
    ),
]
PatchOption = Annotated[
    str | None,
    typer.Option(
        "--patch",
        metavar="DEFINITION",
        help="Put the result into this definition; comments and order stay.",
    ),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON on standard output.")
]


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


def table_of(path: str) -> "Table":
    """Return a CSV of numbers. Raises OSError and InvalidFile."""
    from somo_cli.document.table import read_table

    return read_table(files.read_text(path, LARGEST_TABLE), path)


def keep(
    document: "Document | None",
    values: "Mapping[Pointer, float]",
    piece: str,
    write: str | None,
    patch: str | None,
    beside: Mapping[str, str] | None = None,
) -> None:
    """Write values into a copy of the file that holds them, or into the file itself.

    Without a document `piece` is written. `beside` says after which key a new one goes.
    """
    if write is not None:
        written = piece
        if document is not None:
            (source, *others) = dict.fromkeys(document.span(place[:-1]).source for place in values)
            require(not others, "--write", f"the values are in {source} and other files: --patch")
            written = _patched(document, source, values, beside)
        files.write_whole(write, written)
        terminal.say(f"{write}: written")
    if patch is not None and document is not None:
        files.write_whole(patch, _patched(document, _source(document, patch), values, beside))
        terminal.say(f"{patch}: patched")


def require_targets(document: "Document", write: str | None, patch: str | None) -> None:
    """Refuse, before anything is computed, to patch what was not read, or to write over it."""
    if patch is not None:
        _source(document, patch)
    is_read = write is not None and any(_is_same(write, source) for source in document.texts)
    require(not is_read, "--write", f"{write} is what is read: change it with --patch")


def _source(document: "Document", path: str) -> str:
    """Return the name by which the file to patch was read into a document."""
    for source in document.texts:
        if _is_same(path, source):
            return source
    names = ", ".join(document.texts)
    raise typer.BadParameter(f"{path} is not what was read: {names}", param_hint="'--patch'")


def _is_same(path: str, source: str) -> bool:
    one, other = Path(path), Path(source)
    return path == source or (one.exists() and other.exists() and one.samefile(other))


def _patched(
    document: "Document",
    source: str,
    values: "Mapping[Pointer, float]",
    beside: Mapping[str, str] | None,
) -> str:
    from somo_cli.document.patch import patched

    return patched(document, source, values, after=beside or {})


def numbers_of(option: str, text: str) -> Sequence[int]:
    """Return the whole numbers of a list such as 3,5,10."""
    try:
        found = [int(part) for part in text.split(",")]
    except ValueError:
        found = []
    is_right = bool(found) and all(1 <= number <= 200 for number in found)
    require(is_right, option, f"{text!r} is not a list of numbers from 1 to 200, such as 3,5,10")
    return list(dict.fromkeys(found))


Rule = Literal["exact", "somo"]


def rule_of(text: str) -> Rule:
    """Return the rule of an option."""
    require(text in ("exact", "somo"), "--rule", f"{text!r} is not exact or somo")
    return "somo" if text == "somo" else "exact"
