"""somo calibrate: the group of commands, and the options that they share."""

from collections.abc import Sequence
from typing import Annotated, Literal

import typer

from somo_cli.cli.application import EXIT_CODES, app, require

calibrate = typer.Typer(
    help="Find joint stiffness, torque and damping from measurements.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.add_typer(calibrate, name="calibrate")

DefinitionArgument = Annotated[
    str | None,
    typer.Argument(
        help="The definition to calibrate. [default: that of --patch, else joints given by "
        "--length, --joints, ...]",
        show_default=False,
    ),
]
ActuatorOption = Annotated[
    int, typer.Option("--actuator", min=0, help="Number of the actuator, 0 at the base.")
]
AxisOption = Annotated[
    int,
    typer.Option(
        "--axis", min=0, help="Number of the axis: index in joint_definitions; 0 if planar."
    ),
]
AtOption = Annotated[
    float | None,
    typer.Option(
        "--at",
        metavar="M",
        help="Distance of the force from the base of the actuator [m]. [default: its end]",
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
        help="Distances of the joints of the axis from the base [m], instead of --joints.",
    ),
]
AxesOption = Annotated[
    int, typer.Option("--axes", min=1, max=3, help="Number of alternating axes.")
]
AboutOption = Annotated[
    str, typer.Option("--about", metavar="x|y|z", help="Direction of the axis; z is torsion.")
]
PlacementOption = Annotated[
    str,
    typer.Option("--placement", metavar="uniform|gauss", help="Placement of the joints."),
]
WriteOption = Annotated[
    str | None,
    typer.Option(
        "--write",
        metavar="FILE",
        help="Write the result as YAML: a copy of the definition, else a part of one.",
    ),
]
PatchOption = Annotated[
    str | None,
    typer.Option(
        "--patch",
        metavar="DEFINITION",
        help="Write the result into this definition; comments and order stay.",
    ),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON on standard output.")
]


def parse_joint_counts(option: str, text: str) -> Sequence[int]:
    """Return the numbers of a list such as 3,5,10, without repetitions."""
    try:
        found = [int(part) for part in text.split(",")]
    except ValueError:
        found = []
    is_right = bool(found) and all(1 <= number <= 121 for number in found)
    require(is_right, option, f"{text!r} is not a list of numbers from 1 to 121, such as 3,5,10")
    return list(dict.fromkeys(found))


Rule = Literal["exact", "somo"]


def parse_rule(text: str) -> Rule:
    """Return the rule that an option names."""
    require(text in ("exact", "somo"), "--rule", f"{text!r} is not exact or somo")
    return "somo" if text == "somo" else "exact"
