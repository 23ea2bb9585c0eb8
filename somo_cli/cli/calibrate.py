"""somo calibrate: the options that its commands share."""

from collections.abc import Sequence
from typing import Annotated, Literal

import typer

from somo_cli.cli.application import EXIT_CODES, app, require

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


def parse_joint_counts(option: str, text: str) -> Sequence[int]:
    """Return the whole numbers of a list such as 3,5,10."""
    try:
        found = [int(part) for part in text.split(",")]
    except ValueError:
        found = []
    is_right = bool(found) and all(1 <= number <= 121 for number in found)
    require(is_right, option, f"{text!r} is not a list of numbers from 1 to 121, such as 3,5,10")
    return list(dict.fromkeys(found))


Rule = Literal["exact", "somo"]


def parse_rule(text: str) -> Rule:
    """Return the rule of an option."""
    require(text in ("exact", "somo"), "--rule", f"{text!r} is not exact or somo")
    return "somo" if text == "somo" else "exact"
