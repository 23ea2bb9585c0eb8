"""somo calibrate torque: find joint torque, and torque per pressure, from blocked forces."""

import json
import math
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
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
    parse_rule,
)
from somo_cli.cli.calibrate_joints import (
    JointOptions,
    JointsToCalibrate,
    definition_path,
    joints_to_calibrate,
)
from somo_cli.cli.calibrate_result import write_result
from somo_cli.cli.tables import read_measurements

if TYPE_CHECKING:
    from somo_cli.calibration.blocked_force_points import BlockedForcePoint

PRESSURE, FORCE = "pressure_pa", "force_n"


@calibrate.command(
    short_help="Find the torque per pressure of the joints.",
    epilog=examples_of(
        "somo calibrate torque finger.yaml --force 0.5",
        "somo calibrate torque --patch finger.yaml --data forces.csv",
    ),
)
@report_errors
def torque(
    definition: DefinitionArgument = None,
    force: Annotated[
        float | None,
        typer.Option("--force", metavar="N", help="Blocked force [N]; a moment for torsion [N·m]."),
    ] = None,
    pressure: Annotated[
        float | None, typer.Option("--pressure", metavar="PA", help="Pressure at this force [Pa].")
    ] = None,
    data: Annotated[
        str | None,
        typer.Option(
            "--data",
            metavar="CSV",
            help=f"Several measured points: columns {PRESSURE} and {FORCE}.",
        ),
    ] = None,
    through_zero: Annotated[
        bool, typer.Option("--through-zero", help="Fit a line through zero, without an offset.")
    ] = False,
    small_angles: Annotated[
        bool,
        typer.Option(
            "--small-angles",
            help="With a definition, use the rule of small angles, not the equilibrium.",
        ),
    ] = False,
    rule: Annotated[
        str,
        typer.Option(
            "--rule",
            metavar="exact|somo",
            help="The rule for the torque to write; somo is force times length.",
        ),
    ] = "exact",
    actuator: ActuatorOption = 0,
    axis: AxisOption = 0,
    at: AtOption = None,
    length: LengthOption = None,
    joints: JointsOption = None,
    places: PlacesOption = None,
    axes: AxesOption = 1,
    about: AboutOption = "x",
    placement: PlacementOption = "uniform",
    write: WriteOption = None,
    patch: PatchOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the torque in every joint of an axis that causes a measured blocked force.

    The actuator is clamped at its base, and its tip presses on a rigid surface. For small angles
    the torque follows from the positions of the joints alone. With a definition, whose springs are
    known, the equilibrium is solved for angles of any size. Forces at several pressures give a
    straight line and the torque per pressure, which --patch writes into the joint definition for
    scenes with actuation by pressure.
    """
    from somo_cli.calibration.blocked_force_points import fitted_line, lines, plain_data

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
    points = _points(force, pressure, data)
    pressed = _pressed(known, actuator, axis, small_angles, points)
    through = fitted_line(pressed, which, through_zero or data is None)
    per_pressure = None if through is None else through.per_pressure
    is_patchable = patch is None or per_pressure is not None
    require(
        is_patchable, "--patch", "give --pressure as well: a definition has a torque per pressure"
    )
    if as_json:
        typer.echo(json.dumps(plain_data(pressed, which, through), indent=2))
    else:
        for line in lines(known.moment_arms, pressed, which, through):
            typer.echo(line)
    if through is not None and through.has_offset:
        terminal.print_message(
            f"somo: warning: at zero pressure the line has {through.offset:.3g} N·m, more than the "
            "scatter explains; torque_per_pressure does not include it"
        )
        terminal.print_message(
            "  hint: look for a dead band or an offset of the gauge, or use --through-zero"
        )
    _write_result(known, actuator, axis, pressed[-1].torque(which), per_pressure, write, patch)


def _points(
    force: float | None, pressure: float | None, data: str | None
) -> list[tuple[float | None, float]]:
    require((force is None) != (data is None), "--force", "give --force or --data")
    require(pressure is None or force is not None, "--pressure", "it goes with --force")
    if data is None:
        assert force is not None
        is_force = math.isfinite(force) and force != 0
        require(is_force, "--force", f"{force} is not a finite force other than 0")
        is_pressure = pressure is None or (math.isfinite(pressure) and pressure != 0)
        require(is_pressure, "--pressure", f"{pressure} is not a finite pressure other than 0")
        return [(pressure, force)]
    from somo_cli.document.table import require_columns

    table = read_measurements(data)
    require_columns(table, (PRESSURE, FORCE), None, 3, "a line with an error")
    pressures = table.columns[PRESSURE]
    require(len(set(pressures)) > 1, "--data", "all points are at the same pressure")
    return list(zip(pressures, table.columns[FORCE], strict=True))


def _pressed(
    known: JointsToCalibrate,
    actuator: int,
    axis: int,
    small_angles: bool,
    points: list[tuple[float | None, float]],
) -> "list[BlockedForcePoint]":
    from somo_cli.calibration.blocked_force_points import AxisInDefinition, blocked_force_point

    springs = None
    if known.definition is not None and not small_angles:
        springs = AxisInDefinition(known.definition, actuator, axis)
    found = [
        blocked_force_point(known.moment_arms, springs, pressure, force)
        for pressure, force in points
    ]
    for one in found:
        if springs is not None and one.equilibrium is None and known.moment_arms.kind == "bending":
            terminal.print_message(
                f"somo: warning: at {one.force:g} N there is no equilibrium near the straight pose "
                "with the springs of the definition; the rule of small angles is used"
            )
    return found


def _write_result(
    known: JointsToCalibrate,
    actuator: int,
    axis: int,
    found: float,
    per_pressure: float | None,
    write: str | None,
    patch: str | None,
) -> None:
    from somo_cli.calibration import joint_pointers

    if per_pressure is None:
        piece = (
            "# one entry of the actuation of a manipulator in a scene\n"
            f"actuator: {actuator}\naxis: {axis}\ntorque: {joint_pointers.rounded(found)!r} # N·m\n"
        )
        write_result(None, {}, piece, write, None)
    elif known.document is None:
        piece = (
            "# for the joint_definitions of the axis\n"
            f"torque_per_pressure: {joint_pointers.rounded(per_pressure)!r} # N·m/Pa\n"
        )
        write_result(None, {}, piece, write, None)
    else:
        places = joint_pointers.pointers(known.document, (), actuator, axis)
        values = joint_pointers.values(places, "torque_per_pressure", [per_pressure])
        beside = {"torque_per_pressure": "spring_stiffness"}
        write_result(known.document, values, "", write, patch, beside)
