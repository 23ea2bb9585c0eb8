"""somo calibrate damping: find joint damping from a ring-down or a damping ratio."""

import dataclasses
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
    ActuatorOption,
    AxisOption,
    JsonOption,
    PatchOption,
    WriteOption,
    calibrate,
)
from somo_cli.cli.calibrate_result import require_targets, write_result
from somo_cli.cli.tables import read_measurements
from somo_cli.problems import InvalidFile, Problem

if TYPE_CHECKING:
    from somo_cli.calibration.damping import Mode
    from somo_cli.calibration.ring_down import RingDown
    from somo_cli.document.parse import Document
    from somo_cli.document.table import Table
    from somo_cli.scene.model import Scene


@calibrate.command(
    short_help="Find the damping of the joints from a ring-down.",
    epilog=examples_of(
        "somo calibrate damping finger.yaml --ratio 0.1",
        "somo calibrate damping --patch finger.yaml --ring-down decay.csv",
    ),
)
@report_errors
def damping(
    scene: Annotated[
        str | None,
        typer.Argument(
            help="A definition, taken without gravity, or a scene of it with the gravity and the "
            "pose of the ring-down. [default: the definition of --patch]",
            show_default=False,
        ),
    ] = None,
    ratio: Annotated[
        float | None,
        typer.Option("--ratio", metavar="Z", help="Damping ratio of the lowest mode of the axis."),
    ] = None,
    ring_down: Annotated[
        str | None,
        typer.Option(
            "--ring-down",
            metavar="CSV",
            help="A measured free decay: column time_s, and a position or an angle.",
        ),
    ] = None,
    column: Annotated[
        str | None,
        typer.Option(
            "--column", metavar="NAME", help="The column of the decay, if there are several."
        ),
    ] = None,
    begin: Annotated[
        float,
        typer.Option(
            "--from",
            metavar="S",
            help="Ignore rows before this time [s].",
            show_default=False,
        ),
    ] = -math.inf,
    end: Annotated[
        float,
        typer.Option(
            "--until",
            metavar="S",
            help="Ignore rows after this time [s].",
            show_default=False,
        ),
    ] = math.inf,
    actuator: ActuatorOption = 0,
    axis: AxisOption = 0,
    write: WriteOption = None,
    patch: PatchOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the joint damping that gives the lowest mode of an axis its measured damping ratio.

    The damping is proportional to the stiffness in all joints of the axis. One decaying oscillation
    is fitted to a ring-down. A warning appears if its frequency differs from that of the model:
    mass or stiffness are then wrong.
    """
    from somo_cli.calibration import damping_report
    from somo_cli.calibration.axis_stiffness import axis_stiffness

    require((ratio is None) != (ring_down is None), "--ratio", "give --ratio or --ring-down")
    is_ratio = ratio is None or 0 <= ratio < 10
    require(is_ratio, "--ratio", f"{ratio} is not from 0 to 10")
    path = scene or patch
    require(path is not None, "SCENE", "give a definition or a scene")
    assert path is not None
    document, found = _scene(path)
    require_targets(document, write, patch)
    mode = _mode(found, actuator, axis)
    swing = None if ring_down is None else _ring_down(ring_down, column, begin, end)
    wanted = ratio if swing is None else swing.ratio
    assert wanted is not None
    definition = found.manipulators[0].compiled.definition
    stiffness = axis_stiffness(definition, actuator, axis)
    if as_json:
        data = damping_report.plain_data(mode, swing, wanted, stiffness)
        typer.echo(json.dumps(data, indent=2))
    else:
        for line in damping_report.lines(mode, swing, wanted, stiffness):
            typer.echo(line)
    warning = None if swing is None else damping_report.frequency_warning(mode, swing)
    if warning is not None:
        message, hint = warning
        terminal.print_message(f"somo: warning: {message}")
        terminal.print_message(f"  hint: {hint}")
    damped = [wanted * mode.per_ratio * value for value in stiffness]
    _write_result(document, damped, actuator, axis, write, patch)


def _scene(path: str) -> "tuple[Document, Scene]":
    from somo_cli import document_kinds, loading
    from somo_cli.scene.model import is_scene

    document = loading.load(path)
    found, warnings = loading.scene_of(document)
    terminal.print_problems(warnings, document.texts)
    if not is_scene(document):
        found = dataclasses.replace(found, gravity=(0.0, 0.0, 0.0))
    document_kinds.refuse_multiple(document, found, "a damping ratio is")
    return document, found


def _mode(scene: "Scene", actuator: int, axis: int) -> "Mode":
    from somo_cli.calibration.damping import NoMode, lowest_mode
    from somo_cli.simulation.plan.build import make_plan

    axes = {(j.actuator, j.channel) for j in scene.manipulators[0].compiled.chain.joints}
    is_there = (actuator, axis) in axes
    require(is_there, "--axis", f"axis {axis} of actuator {actuator} moves no joint")
    try:
        return lowest_mode(make_plan(scene), 0, actuator, axis)
    except NoMode as error:
        raise typer.BadParameter(str(error), param_hint="'--axis'") from error


def _ring_down(path: str, column: str | None, begin: float, end: float) -> "RingDown":
    from somo_cli.calibration.measurement import TIME, time_window
    from somo_cli.calibration.ring_down import MINIMUM_POINTS, NoRingDown, ring_down
    from somo_cli.document.table import require_columns

    table = read_measurements(path)
    name = column or _only_column(table)
    require_columns(table, (TIME, name), TIME, MINIMUM_POINTS, "a ring-down")
    try:
        return ring_down(*time_window(table, name, begin, end))
    except NoRingDown as error:
        place = table.header_span(name)
        raise InvalidFile([Problem(place, str(error))], table.texts) from error


def _only_column(table: "Table") -> str:
    names = [name for name in table.names if name != "time_s"]
    if len(names) != 1:
        known = ", ".join(names[:4]) + (", ..." if len(names) > 4 else "") if names else "none"
        message = f"there are {len(names)} columns besides time_s: {known}"
        place = table.header_span(table.names[0])
        hint = (
            "choose the column of the decay with --column"
            if names
            else "add a column with the decay"
        )
        raise InvalidFile([Problem(place, message, hint)], table.texts)
    return names[0]


def _write_result(
    document: "Document",
    damping: list[float],
    actuator: int,
    axis: int,
    write: str | None,
    patch: str | None,
) -> None:
    from somo_cli.calibration import joint_pointers
    from somo_cli.scene.model import is_scene

    at = ("manipulators", 0, "definition") if is_scene(document) else ()
    places = joint_pointers.pointers(document, at, actuator, axis)
    values = joint_pointers.values(places, "spring_damping", damping)
    write_result(document, values, "", write, patch, {"spring_damping": "spring_stiffness"})
