"""somo calibrate fit: stiffness, damping and actuation gain from a recorded motion."""

import json
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import (
    EXIT_CODES,
    OutsideOption,
    PackageOption,
    access_of,
    report_errors,
    require,
)
from somo_cli.cli.calibrate import JsonOption, PatchOption, WriteOption, calibrate
from somo_cli.cli.calibrate_result import require_targets, write_result
from somo_cli.cli.tables import read_table_file

if TYPE_CHECKING:
    from somo_cli.calibration.fit import FitResult
    from somo_cli.calibration.measurement import Measurement
    from somo_cli.calibration.parameters import Parameter, ParameterKind
    from somo_cli.document.parse import Document
    from somo_cli.problems import Pointer
    from somo_cli.scene.model import Scene

MIN_ROWS = 8
_RUNS = 20  # what a bar of progress expects, per parameter


@calibrate.command(epilog=EXIT_CODES)
@report_errors
def fit(
    scene: Annotated[
        str,
        typer.Argument(
            help="A scene of one manipulator, with the known actuation and loads; its values are "
            "the first guess."
        ),
    ],
    data: Annotated[
        str,
        typer.Option(
            "--data",
            metavar="CSV",
            help="What was measured: time_s from the start of the scene, and columns as somo run "
            "calls them, such as tip.x_m [m] or actuator_0_joint_01.angle_rad [rad].",
        ),
    ],
    parameters: Annotated[
        str,
        typer.Option(
            "--parameters",
            metavar="NAME,...",
            help="What to fit on every axis; damping only where there is some, gain, a factor on "
            "the actuation, only where something drives.",
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
    """Fit stiffness, damping and actuation gain of a scene to a measured motion, by simulating.

    Least squares over runs of the scene, with confidence intervals of 95 % for independent noise,
    and a warning where the data cannot tell parameters apart.
    """
    from somo_cli import loading
    from somo_cli.calibration.measurement import TIME, measurement
    from somo_cli.document.table import require_columns

    whats = _fitted_kinds(parameters)
    document = loading.load(scene, (), *access_of(allow_outside, package))
    planned, warnings = loading.scene_of(document)
    terminal.print_problems(warnings, document.texts)
    loading.refuse_overlaps(document, planned)
    document = loading.as_scene(document)
    loading.refuse_multiple(document, planned, "a fit is")
    require_targets(document, write, patch)
    table = read_table_file(data)
    require_columns(table, (TIME,), TIME, MIN_ROWS, "a fit")
    measured = measurement(table, planned, columns.split(",") if columns else ())
    known = _parameters(planned, whats)
    is_kept = write is not None or patch is not None
    is_of_scene = all(_is_for_the_scene(document, one) for one in known)
    is_writable = not (is_kept and is_of_scene)
    require(is_writable, "--patch", "only gains are fitted, and torques are in the scene")
    found = _fitted(planned, measured, known)
    if as_json:
        typer.echo(json.dumps(_plain(found, measured), indent=2))
    else:
        for line in _table(found, measured):
            typer.echo(line)
    from somo_cli.calibration.fit_diagnostics import fit_diagnostics

    for sentence in fit_diagnostics(found, measured.scatter):
        terminal.print_message(f"somo: warning: {sentence}")
    if is_kept:
        values = dict(_values(document, found))
        after = {"spring_damping": "spring_stiffness", "torque_per_pressure": "spring_stiffness"}
        write_result(document, values, "", write, patch, after)
        for one, factor in zip(found.parameters, found.factors.tolist(), strict=True):
            if _is_for_the_scene(document, one):
                terminal.print_message(
                    f"{scene}: multiply by the {one.name}, {factor:.6g}, by hand"
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
    return [what for what in PARAMETER_KINDS if what in names]


def _parameters(scene: "Scene", whats: "Sequence[ParameterKind]") -> "Sequence[Parameter]":
    from somo_cli.calibration.parameters import parameters

    known = list(parameters(scene.manipulators[0], whats))
    message = "the scene has none of these to start from, such as a spring_stiffness above 0"
    require(bool(known), "--parameters", message)
    return known


def _fitted(scene: "Scene", measured: "Measurement", known: "Sequence[Parameter]") -> "FitResult":
    from somo_cli.calibration.fit import NothingToFit, SceneModel
    from somo_cli.calibration.fit import fit as fitted
    from somo_cli.simulation.engine.bullet.c_stdio import stdout_to_stderr
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    with stdout_to_stderr(), terminal.progress(_RUNS * len(known), "fitting: runs") as advance:
        model = SceneModel(scene, measured, BulletWorld, advance)
        try:
            return fitted(model, measured, known)
        except NothingToFit as error:
            raise typer.BadParameter(str(error), param_hint="'--data'") from error


def _values(document: "Document", found: "FitResult") -> "Iterator[tuple[Pointer, float]]":
    """Yield what to write into the definition: all but the gains of torques."""
    from somo_cli.calibration import joint_pointers

    at: Pointer = ("manipulators", 0, "definition")
    keys = {
        "stiffness": "spring_stiffness",
        "damping": "spring_damping",
        "gain": "torque_per_pressure",
    }
    for parameter, factor in zip(found.parameters, found.factors.tolist(), strict=True):
        if _is_for_the_scene(document, parameter):
            continue
        key = keys[parameter.what]
        for place in joint_pointers.pointers(document, at, parameter.actuator, parameter.axis):
            definition = document.at(place)
            assert isinstance(definition, dict)
            if definition.get(key) is not None:
                yield (*place, key), joint_pointers.rounded(float(definition[key]) * factor)


def _is_for_the_scene(document: "Document", parameter: "Parameter") -> bool:
    """Whether a parameter is the gain of torques, for which a definition has no place."""
    from somo_cli.calibration import joint_pointers

    where = parameter.actuator, parameter.axis
    return parameter.what == "gain" and where not in joint_pointers.under_pressure(document, 0)


def _table(found: "FitResult", measured: "Measurement") -> list[str]:
    from somo_cli.analysis.text_table import table_lines
    from somo_cli.calibration.parameters import UNITS

    rows = []
    for number, one in enumerate(found.parameters):
        value, error = found.values[number], found.errors[number]
        rows.append(
            [
                one.name,
                f"{one.guess:.6g}",
                f"{value:.6g}",
                f"{error:.2g}",
                f"{100 * error / abs(value):.2g} %",
                UNITS[one.what],
            ]
        )
    lines = table_lines([["parameter", "guess", "fitted", "± (95 %)", "", "unit"], *rows])
    before, after = found.first_residual_rms, found.residual_rms
    lines += [
        "",
        *table_lines(
            [
                ["residual, root mean square", "guess", "fitted"],
                *(
                    [name, f"{one:.3g}", f"{other:.3g}"]
                    for name, one, other in zip(measured.names, before, after, strict=True)
                ),
            ]
        ),
    ]
    lines.append(f"{len(measured.times)} rows, {found.runs} runs of the scene")
    return lines


def _plain(found: "FitResult", measured: "Measurement") -> dict[str, object]:
    return {
        "parameters": [
            {
                "what": one.what,
                "actuator": one.actuator,
                "axis": one.axis,
                "guess": one.guess,
                "value": float(found.values[number]),
                "error": float(found.errors[number]),
            }
            for number, one in enumerate(found.parameters)
        ],
        "correlation": found.correlation.tolist(),
        "silent": [one.name for one in found.insensitive],
        "columns": list(measured.names),
        "residual_rms": found.residual_rms.tolist(),
        "persistence": found.autocorrelation,
        "runs": found.runs,
    }
