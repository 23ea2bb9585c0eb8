"""somo calibrate stiffness: find joint stiffness from the stiffness of a tip or a beam."""

import json
import math
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli.cli.application import (
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.calibrate import (
    AboutOption,
    ActuatorOption,
    AtOption,
    AxesOption,
    AxisOption,
    DefinitionArgument,
    JointsOption,
    JsonOption,
    LengthOption,
    PatchOption,
    PlacementOption,
    PlacesOption,
    WriteOption,
    calibrate,
    parse_joint_counts,
    parse_rule,
)
from somo_cli.cli.calibrate_joints import (
    JointOptions,
    JointsToCalibrate,
    definition_path,
    joints_to_calibrate,
)
from somo_cli.cli.calibrate_result import write_result

if TYPE_CHECKING:
    from somo_cli.calibration.moment_arms import MomentArms
    from somo_cli.manipulator.definition import Definition


@calibrate.command(
    short_help="Find the stiffness of the joints.",
    epilog=examples_of(
        "somo calibrate stiffness finger.yaml --tip-stiffness 6.12",
        "somo calibrate stiffness --length 0.1 --joints 10 \\",
        "    --modulus 2e5 --section box:0.02,0.01",
    ),
)
@report_errors
def stiffness(
    definition: DefinitionArgument = None,
    tip_stiffness: Annotated[
        float | None,
        typer.Option(
            "--tip-stiffness",
            metavar="K",
            help="Force on the tip over its deflection [N/m]; for torsion, moment over angle "
            "[N·m/rad].",
        ),
    ] = None,
    rigidity: Annotated[
        float | None,
        typer.Option("--rigidity", metavar="EI", help="EI of a beam [N·m²]; GJ for torsion."),
    ] = None,
    modulus: Annotated[
        float | None,
        typer.Option(
            "--modulus",
            metavar="E",
            help="Young's modulus [Pa], with --section, or of the section in the definition.",
        ),
    ] = None,
    section: Annotated[
        str | None,
        typer.Option(
            "--section",
            metavar="SHAPE",
            help="Cross-section [m]: box:X,Y, disc:R or stadium:X,Y (X along x, Y along y).",
        ),
    ] = None,
    bore: Annotated[
        str | None,
        typer.Option("--bore", metavar="SHAPE", help="A concentric hole in the section."),
    ] = None,
    poisson: Annotated[
        float,
        typer.Option("--poisson", help="Poisson's ratio, for torsion: G = E / (2 (1 + ratio))."),
    ] = 0.5,
    actuator: ActuatorOption = 0,
    axis: AxisOption = 0,
    at: AtOption = None,
    length: LengthOption = None,
    joints: JointsOption = None,
    places: PlacesOption = None,
    axes: AxesOption = 1,
    about: AboutOption = "x",
    placement: PlacementOption = "uniform",
    rule: Annotated[
        str,
        typer.Option(
            "--rule",
            metavar="exact|somo",
            help="The rule for the stiffness to write; somo is the formula of SoMo's notes.",
        ),
    ] = "exact",
    numbers: Annotated[
        str,
        typer.Option("--numbers", metavar="N,N,...", help="Numbers of joints to compare."),
    ] = "2,3,5,10,20,40",
    write: WriteOption = None,
    patch: PatchOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the joint stiffness that gives a chain exactly the required tip stiffness.

    The actuator is clamped by itself. Without a required stiffness, the command reports the tip
    stiffness of the definition. The position of every joint is taken into account: alternating
    axes, half segments at the ends, Gauss points.

    The second table compares chains with other numbers of joints, all of this tip stiffness, with
    a uniform beam: along the length under a force on the tip, at the tip under an end moment, under
    the weight of the beam and under a large force, and in the first frequency. The ratio of the
    highest frequency to the first determines how short explicit time steps must be.
    """
    from somo_cli.calibration import report
    from somo_cli.calibration.axis_stiffness import first_joint_stiffness
    from somo_cli.calibration.beam_comparison import compare_placements, compare_with_beam

    which = parse_rule(rule)
    known = joints_to_calibrate(
        definition_path(definition, patch),
        actuator,
        axis,
        at,
        JointOptions(length, joints, places, axes, about, placement),
        write,
        patch,
    )
    moment_arms = known.moment_arms
    own = first_joint_stiffness(known.definition, actuator, axis)
    is_drawn = modulus is not None and section is None and bore is None
    if is_drawn and known.definition is not None:
        section = _section_of_file(known.definition, actuator)
    wanted = _wanted(moment_arms, own, tip_stiffness, rigidity, modulus, section, bore, poisson)
    is_known = which == "exact" or moment_arms.kind == "bending"
    require(is_known, "--rule", "SoMo has no formula for torsion")
    found = (
        moment_arms.stiffness(wanted) if which == "exact" else moment_arms.somo_stiffness(wanted)
    )
    others = list(compare_placements(known.made, parse_joint_counts("--numbers", numbers)))
    this = compare_with_beam(moment_arms, known.placement)
    if as_json:
        typer.echo(
            json.dumps(report.plain_data(moment_arms, wanted, found, [*others, this]), indent=2)
        )
    else:
        typer.echo(report.described(moment_arms))
        for line in report.stiffness_lines(moment_arms, wanted, own):
            typer.echo(line)
        typer.echo("")
        typer.echo("chains of this tip stiffness against a uniform beam:")
        for line in report.comparison_lines(others, wanted, this):
            typer.echo(line)
    _write_result(known, actuator, axis, found, write, patch)


def _wanted(
    moment_arms: "MomentArms",
    own: float | None,
    tip_stiffness: float | None,
    rigidity: float | None,
    modulus: float | None,
    section: str | None,
    bore: str | None,
    poisson: float,
) -> float:
    """Return the tip stiffness that the options require, or else that of the definition."""
    options = {"--tip-stiffness": tip_stiffness, "--rigidity": rigidity, "--modulus": modulus}
    chosen = [name for name, value in options.items() if value is not None]
    names = "--tip-stiffness, --rigidity or --modulus with --section"
    is_asked = len(chosen) == 1 or not (chosen or own is None)
    require(is_asked, chosen[-1] if chosen else "--tip-stiffness", f"give one of {names}")
    for name, value in options.items():
        is_right = value is None or 0 < value < math.inf
        require(is_right, name, f"{value} is not greater than 0, and finite")
    require((section is None) == (modulus is None), "--section", "it goes with --modulus")
    require(bore is None or section is not None, "--bore", "it goes with --section")
    require(-1 < poisson <= 0.5, "--poisson", f"{poisson} is not greater than -1, at most 0.5")
    if tip_stiffness is not None:
        return tip_stiffness
    if modulus is not None and section is not None:
        rigidity = modulus * _moment(moment_arms, section, bore, poisson)
    if rigidity is None:
        assert own is not None
        return moment_arms.tip_stiffness(own)
    return moment_arms.tip_stiffness_of_beam(rigidity)


def _section_of_file(definition: "Definition", actuator: int) -> str:
    """Return the section of the links of an actuator, as `--section` takes it."""
    from somo_cli.manipulator.solids import Box, Cylinder

    solid = definition.actuators[actuator].link.solid
    if isinstance(solid, Box):
        return f"box:{solid.size[0]!r},{solid.size[1]!r}"
    is_round = isinstance(solid, Cylinder)
    require(is_round, "--section", "the links are spheres, which have none: give it")
    return f"disc:{solid.radius!r}"


def _moment(moment_arms: "MomentArms", section: str, bore: str | None, poisson: float) -> float:
    """Return rigidity over modulus [m⁴]: I, or J / (2 (1 + Poisson's ratio)) for torsion."""
    from somo_cli.manipulator.section import parse_section

    try:
        shape = parse_section(section)
        if bore is not None:
            shape = shape.without(parse_section(bore))
        if moment_arms.kind == "torsion":
            return shape.torsion_constant() / (2 * (1 + poisson))
        return shape.second_moment(moment_arms.direction[:2])
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--section'") from error


def _write_result(
    known: JointsToCalibrate,
    actuator: int,
    axis: int,
    found: float,
    write: str | None,
    patch: str | None,
) -> None:
    from somo_cli.calibration import joint_pointers

    if known.document is None:
        direction = ", ".join(f"{value:g}" for value in known.moment_arms.direction)
        piece = (
            "# one of the joint_definitions of an actuator\n"
            "joint_type: continuous\n"
            f"axis: [{direction}]\n"
            f"spring_stiffness: {joint_pointers.rounded(found)!r} # N·m/rad\n"
        )
        write_result(None, {}, piece, write, patch)
        return
    places = joint_pointers.pointers(known.document, (), actuator, axis)
    wanted = (found * known.moment_arms.profile).tolist()
    values = joint_pointers.values(places, "spring_stiffness", wanted)
    write_result(known.document, values, "", write, patch, {"spring_stiffness": "limits"})
