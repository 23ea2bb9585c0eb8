"""somo new: first files of a user's own."""

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from somo_cli import output_files, terminal
from somo_cli.cli.application import (
    QuietOption,
    app,
    examples_of,
    report_errors,
    require,
)

if TYPE_CHECKING:
    from somo_cli.templates.scenes import Varied
    from somo_cli.templates.sizes import Sizes

KINDS = ("finger", "gripper", "arm", "snake", "scene", "study")
_SIZED = ("finger", "gripper", "arm", "snake")


@app.command(
    short_help="Write a first definition, scene or study.",
    epilog=examples_of(
        "somo new finger mine",
        "somo new gripper mine --length 0.08 --modulus 3e5",
        "somo new study mine_study --of mine_scene.yaml",
    ),
)
@report_errors
def new(
    kind: Annotated[str, typer.Argument(metavar="|".join(KINDS), help="What to write.")],
    name: Annotated[str, typer.Argument(help="Its name; files are called NAME.yaml, ...")],
    length: Annotated[
        float | None, typer.Option("--length", metavar="M", help="Length of the whole [m].")
    ] = None,
    width: Annotated[
        float | None, typer.Option("--width", metavar="M", help="Width of the section [m].")
    ] = None,
    depth: Annotated[
        float | None,
        typer.Option("--depth", metavar="M", help="Depth of the section, the way it bends [m]."),
    ] = None,
    segments: Annotated[
        int | None, typer.Option("--segments", min=2, max=121, help="Number of segments.")
    ] = None,
    modulus: Annotated[
        float | None, typer.Option("--modulus", metavar="PA", help="Young's modulus [Pa].")
    ] = None,
    density: Annotated[
        float | None, typer.Option("--density", metavar="KG/M3", help="Density [kg/m³].")
    ] = None,
    fingers: Annotated[
        int, typer.Option("--fingers", min=3, max=8, help="Fingers of a gripper.")
    ] = 3,
    of: Annotated[
        str | None,
        typer.Option(
            "--of", metavar="FILE", help="The definition of a new scene; the scene of a new study."
        ),
    ] = None,
    is_forced: Annotated[
        bool, typer.Option("--force", help="Replace files that are there already.")
    ] = False,
    quiet: QuietOption = False,
) -> None:
    """Write a small, commented start that passes every check and runs."""
    require(kind in KINDS, "KIND", f"{kind!r} is not one of {', '.join(KINDS)}")
    given = {
        "length": length,
        "width": width,
        "depth": depth,
        "segments": segments,
        "modulus": modulus,
        "density": density,
    }
    changes = {key: value for key, value in given.items() if value is not None}
    for key, value in changes.items():
        require(kind in _SIZED, f"--{key}", f"it is not for a {kind}")
        require(1e-6 <= value <= 1e15, f"--{key}", f"{value:g} is not from 1e-6 to 1e15")
    stem = Path(name).name
    is_name = stem.isascii() and stem.replace("_", "a").isalnum() and not stem[0].isdigit()
    require(is_name, "NAME", f"{name!r} is not a name: letters, digits and _, a letter first")
    require((of is not None) == (kind not in _SIZED), "--of", _of_what(kind))
    written = {
        str(Path(name).with_name(file)): text
        for file, text in _files(kind, stem, changes, fingers, of).items()
    }
    _refuse_unsound(written)
    there = [path for path in written if Path(path).exists()]
    require(is_forced or not there, "NAME", f"{', '.join(there)} is there: --force replaces it")
    for path, text in written.items():
        output_files.write_atomically(path, text)
        typer.echo(path)
    last = list(written)[-1]
    if not quiet:
        terminal.print_message(f"next: {_next(kind, last)}")


def _files(
    kind: str, stem: str, changes: Mapping[str, float], fingers: int, of: str | None
) -> dict[str, str]:
    """Return the files of a kind by name, definitions before the scenes that name them."""
    from somo_cli.templates import bodies, scenes, sizes

    if kind == "scene":
        return {f"{stem}.yaml": scenes.bending_scene(stem, str(of), _torque_of(str(of)))}
    if kind == "study":
        return {f"{stem}.yaml": scenes.study(stem, str(of), _varied_of(str(of)))}
    body, scene = f"{stem}.yaml", f"{stem}_scene"
    if kind == "finger":
        own = _sized(sizes.FINGER, changes, 1)
        bending = scenes.bending_scene(scene, body, own.torque(0.8))
        return {body: bodies.finger(stem, own), f"{scene}.yaml": bending}
    if kind == "gripper":
        own = _sized(sizes.FINGER, changes, 1)
        body = f"{stem}_finger.yaml"
        grasp = scenes.gripper_scene(scene, body, own, fingers)
        return {body: bodies.finger(f"{stem}_finger", own), f"{scene}.yaml": grasp}
    if kind == "arm":
        own = _sized(sizes.ARM, changes, sizes.ARM_ACTUATORS)
        bending = scenes.bending_scene(scene, body, own.torque(0.8))
        return {body: bodies.arm(stem, own, sizes.ARM_ACTUATORS), f"{scene}.yaml": bending}
    own = _sized(sizes.SNAKE, changes, sizes.SNAKE_ACTUATORS)
    crawl = scenes.snake_scene(scene, body, own)
    return {body: bodies.snake(stem, own, sizes.SNAKE_ACTUATORS), f"{scene}.yaml": crawl}


def _sized(start: "Sizes", changes: Mapping[str, float], actuators: int) -> "Sizes":
    changed = dataclasses.replace(start, **changes)  # type: ignore[arg-type]
    is_divided = changed.segments % (actuators * changed.axes) == 0
    multiple = actuators * changed.axes
    require(is_divided, "--segments", f"{changed.segments} is not a multiple of {multiple}")
    return changed


def _torque_of(definition: str) -> float | None:
    """Return the torque [N·m] that bends the first axis of a definition by 0.8 rad."""
    from somo_cli import document_kinds, loading

    document = loading.load(definition)
    document_kinds.refuse_scene(document)
    (only,) = loading.scene_of(document)[0].manipulators
    joints = only.compiled.chain.joints
    stiffness = [one.stiffness for one in joints if (one.actuator, one.channel) == (0, 0)]
    return 0.8 / sum(1 / one for one in stiffness) if stiffness and all(stiffness) else None


def _varied_of(scene: str) -> "Varied":
    """Return what a first study of a scene varies: its first drive, else its time step."""
    from somo_cli import loading
    from somo_cli.scene.available_columns import available_columns
    from somo_cli.templates.scenes import Varied

    document = loading.load(scene)
    planned, _ = loading.scene_of(document)
    recorded = [one for one in available_columns(planned) if one.recorded == len(one.names)]
    column = next((one for one in recorded if one.quantity == "tip_position"), recorded[0]).names[
        -1
    ]
    drive: Any = ("manipulators", 0, "actuation", 0)
    try:
        points: Any = document.at((*drive, "waypoints"))
        path = f"manipulators[0].actuation[0].waypoints[{len(points) - 1}][1]"
        return Varied("drive", path, float(points[-1][1]) or 0.01, column)
    except (KeyError, IndexError, TypeError):
        return Varied("step", "time_step", planned.time_step, column)


def _refuse_unsound(written: Mapping[str, str]) -> None:
    """Exit with a usage error where sizes lead to a definition with errors."""
    from somo_cli import loading
    from somo_cli.problems import has_errors

    for path, text in written.items():
        document = loading.load_text(text, path) if "actuator_definitions" in text else None
        problems = () if document is None else loading.check(document)
        message = "; ".join(one.message for one in problems if one.severity == "error")
        message = f"with these sizes {path} has errors: {message}"
        require(not has_errors(problems), "--length", message)


def _of_what(kind: str) -> str:
    if kind in _SIZED:
        return f"it is not for a {kind}, which brings its own files"
    what = "the definition that stands in the scene" if kind == "scene" else "the scene to vary"
    return f"give {what}"


def _next(kind: str, path: str) -> str:
    return f"somo sweep {path}" if kind == "study" else f"somo run {path}"
