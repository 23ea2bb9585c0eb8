"""somo calibrate: choose the joints to calibrate, of a definition or given by options."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from somo_cli import terminal
from somo_cli.cli.application import require
from somo_cli.cli.calibrate_result import require_targets

if TYPE_CHECKING:
    from somo_cli.calibration.moment_arms import MomentArms
    from somo_cli.document.parse import Document
    from somo_cli.manipulator.definition import Definition, Placement


@dataclass(frozen=True, slots=True)
class JointsToCalibrate:
    """The joints to calibrate: of a definition, or given by options.

    `made` returns the moment arms of the axis with another number and placement of joints.
    """

    moment_arms: "MomentArms"
    made: "Callable[[int, Placement], MomentArms]"
    placement: "Placement"
    document: "Document | None" = None
    definition: "Definition | None" = None


@dataclass(frozen=True, slots=True)
class JointOptions:
    """The options that give joints without a definition: length [m], joints or places [m], ..."""

    length: float | None
    joints: int | None
    places: str | None
    axes: int
    about: str
    placement: str


def definition_path(definition: str | None, patch: str | None) -> str | None:
    """Return the definition to read: the argument, else the one to patch."""
    is_one = (
        definition is None or patch is None or Path(definition).resolve() == Path(patch).resolve()
    )
    require(
        is_one, "--patch", f"it names another definition than {definition}: give one of the two"
    )
    return definition or patch


def joints_to_calibrate(
    path: str | None,
    actuator: int,
    axis: int,
    at: float | None,
    joint_options: JointOptions,
    write: str | None,
    patch: str | None,
) -> JointsToCalibrate:
    """Return the joints to calibrate; exit with a usage error if there are none."""
    from somo_cli.calibration.moment_arms import NoMomentArms

    try:
        if path is None:
            return _from_numbers(axis, at, joint_options)
        known = _from_definition(path, actuator, axis, at)
        assert known.document is not None
        require_targets(known.document, write, patch)
        return known
    except NoMomentArms as error:
        raise typer.BadParameter(str(error), param_hint="'--axis'") from error


def _from_definition(path: str, actuator: int, axis: int, at: float | None) -> JointsToCalibrate:
    from somo_cli import document_kinds, loading
    from somo_cli.calibration import moment_arms
    from somo_cli.manipulator.compile import compile_definition

    document = loading.load(path)
    document_kinds.refuse_scene(document)
    document_kinds.refuse_assembly(document, "a calibration is")
    compiled = compile_definition(document)
    terminal.print_problems(compiled.warnings, document.texts)
    known = moment_arms.of_definition(compiled.definition, actuator, axis, at)
    one = compiled.definition.actuators[actuator]
    axes = max(one.channels) + 1

    def made(count: int, placement: "Placement") -> "MomentArms":
        return moment_arms.of_uniform_actuator(
            known.length, count, axes, axis, known.direction, placement, known.at
        )

    return JointsToCalibrate(known, made, one.placement, document, compiled.definition)


def _from_numbers(axis: int, at: float | None, joint_options: JointOptions) -> JointsToCalibrate:
    from somo_cli.calibration import moment_arms

    directions = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    about, axes, length, joints = (
        joint_options.about,
        joint_options.axes,
        joint_options.length,
        joint_options.joints,
    )
    require(about in directions, "--about", f"{about!r} is not x, y or z")
    is_known = joint_options.placement in ("uniform", "gauss")
    require(is_known, "--placement", f"{joint_options.placement!r} is not uniform or gauss")
    if length is None or (joints is None) == (joint_options.places is None):
        raise typer.BadParameter(
            "give a definition, or --length and --joints or --places", param_hint="'DEFINITION'"
        )
    require(0 < length < 1e6, "--length", f"{length} is not greater than 0 and less than 1e6")
    require(axis < axes, "--axis", f"axis {axis} is not one of {axes}: give --axes")
    where: Placement = "gauss" if joint_options.placement == "gauss" else "uniform"

    def made(count: int, other: "Placement") -> "MomentArms":
        return moment_arms.of_uniform_actuator(
            length, count, axes, axis, directions[about], other, at
        )

    if joints is not None:
        require(0 < joints <= 1000, "--joints", f"{joints} is not from 1 to 1000")
        return JointsToCalibrate(made(joints, where), made, where)
    assert joint_options.places is not None
    places = _places(joint_options.places)
    return JointsToCalibrate(
        moment_arms.of_joint_positions(length, places, directions[about], at), made, where
    )


def _places(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        message = f"{text!r} is not a list of places in metres, such as 0.01,0.03"
        raise typer.BadParameter(message, param_hint="'--places'") from None
