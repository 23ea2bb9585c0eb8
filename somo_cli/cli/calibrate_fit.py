"""somo calibrate fit: find stiffness, damping and actuation gain from a recorded motion."""

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import (
    OutsideOption,
    PackageOption,
    access_of,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.calibrate import JsonOption, PatchOption, WriteOption, calibrate
from somo_cli.cli.calibrate_result import require_targets, write_result
from somo_cli.cli.tables import read_measurements

if TYPE_CHECKING:
    from somo_cli.calibration.fit import FitResult
    from somo_cli.calibration.measurement import Measurement
    from somo_cli.calibration.parameters import Parameter, ParameterKind
    from somo_cli.scene.model import Scene

MIN_ROWS = 8
_RUNS = 20  # runs per parameter that the progress bar expects


@calibrate.command(
    short_help="Fit a scene to a recorded motion.",
    epilog=examples_of("somo calibrate fit scene.yaml --data motion.csv --parameters stiffness"),
)
@report_errors
def fit(
    scene: Annotated[
        str,
        typer.Argument(
            help="A scene of one manipulator with the known actuation and loads. Its values are "
            "the first guess."
        ),
    ],
    data: Annotated[
        str,
        typer.Option(
            "--data",
            metavar="CSV",
            help="The measured motion: time_s from the start of the scene, and columns named as "
            "somo run names them, such as tip.x_m or actuator_0_joint_01.angle_rad.",
        ),
    ],
    parameters: Annotated[
        str,
        typer.Option(
            "--parameters",
            metavar="NAME,...",
            help="What to fit on each axis: stiffness, damping where it is not zero, and gain, a "
            "factor on the actuation, where there is actuation.",
        ),
    ] = "stiffness,damping,gain",
    columns: Annotated[
        str | None,
        typer.Option(
            "--columns", metavar="NAME,...", help="Columns to fit. [default: all but time_s]"
        ),
    ] = None,
    write: WriteOption = None,
    patch: PatchOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
    as_json: JsonOption = False,
) -> None:
    """Fit stiffness, damping and actuation gain of a scene to a measured motion.

    The fit is by least squares over runs of the scene. It gives 95 % confidence intervals, which
    assume independent noise, and warns if the data do not distinguish parameters.
    """
    from somo_cli import document_kinds, loading
    from somo_cli.calibration import fit_report
    from somo_cli.calibration.fit_diagnostics import fit_diagnostics
    from somo_cli.calibration.fitted_values import definition_values, is_torque_gain
    from somo_cli.calibration.measurement import TIME, measurement
    from somo_cli.document.table import require_columns

    kinds = _fitted_kinds(parameters)
    document = loading.load(scene, (), *access_of(allow_outside, package))
    planned, warnings = loading.scene_of(document)
    terminal.print_problems(warnings, document.texts)
    loading.refuse_overlaps(document, planned)
    document = loading.as_scene(document)
    document_kinds.refuse_multiple(document, planned, "a fit is")
    require_targets(document, write, patch)
    table = read_measurements(data)
    require_columns(table, (TIME,), TIME, MIN_ROWS, "a fit")
    measured = measurement(table, planned, columns.split(",") if columns else ())
    known = _parameters(planned, kinds)
    is_kept = write is not None or patch is not None
    is_all_torque_gains = all(is_torque_gain(document, one) for one in known)
    is_writable = not (is_kept and is_all_torque_gains)
    require(is_writable, "--patch", "only torque gains are fitted; a definition has no torques")
    found = _fitted(planned, measured, known)
    if as_json:
        typer.echo(json.dumps(fit_report.plain_data(found, measured), indent=2))
    else:
        for line in fit_report.lines(found, measured):
            typer.echo(line)
    for sentence in fit_diagnostics(found, measured.scatter):
        terminal.print_message(f"somo: warning: {sentence}")
    if is_kept:
        values = dict(definition_values(document, found))
        after = {"spring_damping": "spring_stiffness", "torque_per_pressure": "spring_stiffness"}
        write_result(document, values, "", write, patch, after)
        for one, factor in zip(found.parameters, found.factors.tolist(), strict=True):
            if is_torque_gain(document, one):
                terminal.print_message(
                    f"{scene}: multiply the torques by the {one.name}, {factor:.6g}, by hand"
                )


def _fitted_kinds(text: str) -> "Sequence[ParameterKind]":
    from somo_cli.calibration.parameters import PARAMETER_KINDS

    names = [name.strip() for name in text.split(",")]
    unknown = [name for name in names if name not in PARAMETER_KINDS]
    require(
        not unknown,
        "--parameters",
        f"{', '.join(unknown)!r} is not one of {', '.join(PARAMETER_KINDS)}",
    )
    return [kind for kind in PARAMETER_KINDS if kind in names]


def _parameters(scene: "Scene", kinds: "Sequence[ParameterKind]") -> "Sequence[Parameter]":
    from somo_cli.calibration.parameters import parameters

    known = list(parameters(scene.manipulators[0], kinds))
    message = "the scene has no first guess for any of these, such as a spring_stiffness above 0"
    require(bool(known), "--parameters", message)
    return known


def _fitted(scene: "Scene", measured: "Measurement", known: "Sequence[Parameter]") -> "FitResult":
    from somo_cli.calibration.fit import NothingToFit, SceneModel
    from somo_cli.calibration.fit import fit as fitted
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    with stdout_to_stderr(), terminal.progress(_RUNS * len(known), "runs of the fit") as advance:
        model = SceneModel(scene, measured, BulletWorld, advance)
        try:
            return fitted(model, measured, known)
        except NothingToFit as error:
            raise typer.BadParameter(str(error), param_hint="'--data'") from error
