"""somo render: a scene, or a recorded run, to a picture."""

import dataclasses
import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import files, terminal
from somo_cli.cli.door import (
    EXIT_CODES,
    OutsideOption,
    QuietOption,
    SetOption,
    app,
    ending,
    refuse_overwriting,
    require,
)

if TYPE_CHECKING:
    from somo_cli.document.parse import Document
    from somo_cli.picture.camera import View
    from somo_cli.picture.draw import Look
    from somo_cli.picture.recording import Recording
    from somo_cli.simulation.scene import Scene

MOST_PIXELS = 4096  # across or down


@app.command(epilog=EXIT_CODES)
@ending
def render(
    source: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene, or a definition by itself.")
    ],
    at: Annotated[
        float, typer.Option("--at", metavar="S", help="The instant to show, in seconds.")
    ] = 0.0,
    camera: Annotated[
        str,
        typer.Option(
            "--camera",
            metavar="VIEW",
            help="oblique, front, side, top, or YAW,PITCH[,DISTANCE] in degrees and metres: yaw 0 "
            "sees the front along +y, 90 from +x; pitch is the height above the horizon.",
        ),
    ] = "oblique",
    target: Annotated[
        str | None,
        typer.Option(
            "--target",
            metavar="X,Y,Z",
            help="The point in the middle of the picture [m]. [default: all that moves is in it]",
        ),
    ] = None,
    size: Annotated[
        str, typer.Option("--size", metavar="WxH", help="Width and height in pixels.")
    ] = "960x720",
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Where to write, a .png. [default: the scene's name with .png, in the current "
            "directory]",
        ),
    ] = None,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    quiet: QuietOption = False,
) -> None:
    """Draw a scene at an instant, without a display."""
    from somo_cli import loading
    from somo_cli.picture.draw import pictures
    from somo_cli.picture.png import png

    look = _look(camera, target, size)
    require(0 <= at <= 1e6, "--at", f"{at} is not from 0 to 1e6")
    target_file = output or f"{Path(source).stem}.png"
    require(target_file.lower().endswith(".png"), "--output", f"{target_file} is not a .png")
    document = loading.load(source, sets or [], allow_outside)
    scene, warnings = loading.scene_of(document)
    terminal.say_problems(warnings, document.texts)
    refuse_overwriting(document, target_file)
    recording = _simulated(document, scene, at)
    (picture,) = pictures(scene, [recording.at(at)], look)
    files.write_whole(target_file, png(picture))
    if not quiet:
        width, height = look.size
        terminal.say(f"{target_file}: {width} x {height} pixels, at {recording.times[-1]:g} s")


def _look(camera: str, target: str | None, size: str) -> "Look":
    from somo_cli.picture.draw import Look

    width, _, height = size.partition("x")
    is_size = all(part.isascii() and part.isdigit() for part in (width, height))
    require(
        is_size and all(16 <= int(part) <= MOST_PIXELS for part in (width, height)),
        "--size",
        f"{size!r} is not two numbers of pixels from 16 to {MOST_PIXELS}, such as 960x720",
    )
    view = _view(camera)
    if target is not None:
        point = _numbers(target, "--target", (3,))
        view = dataclasses.replace(view, target=(point[0], point[1], point[2]))
    return Look(view, (int(width), int(height)))


def _view(camera: str) -> "View":
    from somo_cli.picture.camera import VIEWS, View

    if camera in VIEWS:
        return VIEWS[camera]
    require("," in camera, "--camera", f"{camera!r} is not one of {', '.join(VIEWS)}, or YAW,PITCH")
    numbers = _numbers(camera, "--camera", (2, 3))
    require(abs(numbers[1]) <= 90, "--camera", f"a pitch of {numbers[1]:g} is beyond 90 degrees")
    distance = numbers[2] if len(numbers) == 3 else None
    require(distance is None or distance > 0, "--camera", f"{distance} m is no distance")
    return View(math.radians(numbers[0]), math.radians(numbers[1]), distance)


def _numbers(text: str, option: str, counts: tuple[int, ...]) -> tuple[float, ...]:
    try:
        numbers = tuple(map(float, text.split(",")))
    except ValueError:
        numbers = ()
    is_right = len(numbers) in counts and all(map(math.isfinite, numbers))
    count = " or ".join(map(str, counts))
    require(is_right, option, f"{text!r} is not {count} numbers with commas between them")
    return numbers


def _simulated(document: "Document", scene: "Scene", until: float) -> "Recording":
    from somo_cli import loading
    from somo_cli.picture.recording import Recording, drawn
    from somo_cli.simulation import columns
    from somo_cli.simulation.bullet import BulletWorld
    from somo_cli.simulation.plan import make_plan
    from somo_cli.simulation.run import run

    steps = round(until / scene.time_step)
    loading.refuse_overlaps(document, scene)
    plan = make_plan(dataclasses.replace(drawn(scene), every=max(steps, 1)))
    rows: list[tuple[float, ...]] = []
    with BulletWorld(plan) as world, terminal.progress(steps, "simulating") as advance:
        run(plan, world, lambda row: rows.append(tuple(row)), steps, time.perf_counter, advance)
    names = columns.header(plan)
    return Recording(scene, dict(zip(names, zip(*rows, strict=True), strict=True)))
