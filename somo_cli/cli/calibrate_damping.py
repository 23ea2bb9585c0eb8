"""somo calibrate damping: from a ring-down, or a damping ratio, to the damping of joints."""

import dataclasses
import json
import math
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import EXIT_CODES, report_errors, require
from somo_cli.cli.calibrate import (
    ActuatorOption,
    AxisOption,
    JsonOption,
    PatchOption,
    WriteOption,
    calibrate,
)
from somo_cli.cli.calibrate_result import require_targets, write_result
from somo_cli.cli.tables import read_table_file
from somo_cli.problems import InvalidFile, Problem

if TYPE_CHECKING:
    from somo_cli.calibration.damping import Mode
    from somo_cli.calibration.ring_down import RingDown
    from somo_cli.document.parse import Document
    from somo_cli.document.table import Table
    from somo_cli.scene.model import Scene

_APART = 0.05  # of the frequencies measured and modelled: what is worth a warning


@calibrate.command(epilog=EXIT_CODES)
@report_errors
def damping(
    scene: Annotated[
        str | None,
        typer.Argument(
            help="A definition, taken as weightless, or a scene of it with the gravity and the "
            "pose in which it rings. [default: the definition of --patch]",
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
            help="A measured free decay instead: column time_s, and a position or an angle.",
        ),
    ] = None,
    column: Annotated[
        str | None,
        typer.Option("--column", metavar="NAME", help="The column that rings, if there are more."),
    ] = None,
    begin: Annotated[
        float,
        typer.Option(
            "--from",
            metavar="S",
            help="Leave out what is before this time [s].",
            show_default=False,
        ),
    ] = -math.inf,
    end: Annotated[
        float,
        typer.Option(
            "--until",
            metavar="S",
            help="Leave out what is after this time [s].",
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

    Damping is made proportional to stiffness in all joints of the axis. The ring-down is fitted by
    one decaying swing; its frequency is compared with that of the model, which tells whether mass
    and stiffness are right.
    """
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
    seconds = wanted * mode.per_ratio
    if as_json:
        about: dict[str, object] = {
            "frequency_model": mode.frequency,
            "ratio_model": mode.ratio,
            "ratio": wanted,
            "damping_over_stiffness": seconds,
        }
        if swing is not None:
            about["ring_down"] = dataclasses.asdict(swing)
        about["spring_damping"] = [seconds * value for value in _stiffness(found, actuator, axis)]
        typer.echo(json.dumps(about, indent=2))
    else:
        _print(found, mode, swing, wanted, actuator, axis)
    if swing is not None and abs(mode.frequency / swing.frequency - 1) > _APART:
        terminal.print_message(
            f"somo: warning: the model swings at {mode.frequency:.4g} rad/s, what was measured at "
            f"{swing.frequency:.4g}"
        )
        terminal.print_message(
            "  hint: stiffness over inertia should be "
            f"{(swing.frequency / mode.frequency) ** 2:.3g} times what it is; check the mass, the "
            "stiffness, and that the scene is how it hung"
        )
    _write_result(document, found, actuator, axis, seconds, write, patch)


def _scene(path: str) -> "tuple[Document, Scene]":
    from somo_cli import loading
    from somo_cli.scene.model import is_scene

    document = loading.load(path)
    found, warnings = loading.scene_of(document)
    terminal.print_problems(warnings, document.texts)
    if not is_scene(document):
        found = dataclasses.replace(found, gravity=(0.0, 0.0, 0.0))
    loading.refuse_multiple(document, found, "it is")
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

    table = read_table_file(path)
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
        message = f"there are {len(names)} columns beside time_s: {known}"
        place = table.header_span(table.names[0])
        hint = "choose the one that rings with --column" if names else "add a column that rings"
        raise InvalidFile([Problem(place, message, hint)], table.texts)
    return names[0]


def _stiffness(scene: "Scene", actuator: int, axis: int) -> list[float]:
    """Return the stiffness of the joint definitions of the axis, one or each."""
    one = scene.manipulators[0].compiled.definition.actuators[actuator]
    pairs = zip(one.channels, one.joints, strict=True)
    found = [joint.stiffness for channel, joint in pairs if channel == axis]
    return found if len(set(found)) > 1 else found[:1]


def _print(
    scene: "Scene",
    mode: "Mode",
    swing: "RingDown | None",
    wanted: float,
    actuator: int,
    axis: int,
) -> None:
    from somo_cli.analysis.text_table import table_lines
    from somo_cli.calibration.report import with_error

    rows = [["model as it is", f"{mode.frequency:.6g} rad/s", f"{mode.ratio:.4g}"]]
    if swing is not None:
        frequency = with_error(swing.frequency, swing.frequency_error, "rad/s")
        rows.append(["measured", frequency, with_error(swing.ratio, swing.ratio_error, "").strip()])
    for line in table_lines([["lowest mode of the axis", "frequency", "damping ratio"], *rows]):
        typer.echo(line)
    if swing is not None:
        typer.echo(
            f"ring-down: {swing.periods:.3g} periods, decay {swing.decay:.4g} 1/s, "
            f"residual {swing.residual:.2g}, {100 * swing.explained:.4g} % of the motion explained"
        )
    if mode.is_alone:
        typer.echo("there are other actuators: all other joints are taken as held")
    elif mode.share < 0.99:
        typer.echo(f"{100 * mode.share:.3g} % of the mode's elastic energy is in this axis")
    seconds = wanted * mode.per_ratio
    values = [f"{seconds * value:.6g}" for value in _stiffness(scene, actuator, axis)]
    typer.echo(
        f"for a damping ratio of {wanted:.4g}: spring_damping {', '.join(values)} N·m·s/rad, "
        f"{seconds:.4g} s times spring_stiffness"
    )


def _write_result(
    document: "Document",
    scene: "Scene",
    actuator: int,
    axis: int,
    seconds: float,
    write: str | None,
    patch: str | None,
) -> None:
    from somo_cli.calibration import joint_pointers
    from somo_cli.scene.model import is_scene

    at = ("manipulators", 0, "definition") if is_scene(document) else ()
    places = joint_pointers.pointers(document, at, actuator, axis)
    stiffness = _stiffness(scene, actuator, axis)
    profile = [value / stiffness[0] for value in stiffness]
    values = joint_pointers.values(
        places,
        "spring_damping",
        seconds * stiffness[0],
        profile if len(profile) == len(places) else None,
    )
    write_result(document, values, "", write, patch, {"spring_damping": "spring_stiffness"})
