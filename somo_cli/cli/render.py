"""somo render: draw a scene or a recorded run, as a picture or a film."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import output_files, terminal
from somo_cli.budget import Budget
from somo_cli.cli import render_simulation, render_source
from somo_cli.cli.application import (
    MemoryOption,
    OutsideOption,
    PackageOption,
    QuietOption,
    SecondsOption,
    SetOption,
    access_of,
    app,
    budget_of,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_overwriting
from somo_cli.cli.render_look import look_of
from somo_cli.cli.render_timing import Timing
from somo_cli.cli.simulated_time import DurationOption, StepsOption

if TYPE_CHECKING:
    from somo_cli.picture.draw import PictureSettings
    from somo_cli.picture.facets import Array
    from somo_cli.picture.recorded_motion import RecordedMotion

STILL = ".png"


@app.command(
    short_help="Draw a scene or a recorded run: still or film.",
    epilog=examples_of(
        "somo render scene.yaml --at 0.5",
        "somo render scene.yaml --duration 2 -o film.mp4",
        "somo render run.csv -o film.gif --speed 0.5",
    ),
)
@report_errors
def render(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SCENE|CSV",
            help="A scene or a definition, which is simulated, or a CSV of somo run.",
        ),
    ],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="A still (.png), or a film (.mp4 or .gif; needs somo-cli[film]). [default: the "
            "source's name with .png, in the current directory]",
        ),
    ] = None,
    at: Annotated[
        float | None,
        typer.Option(
            "--at",
            metavar="S",
            help="Time of a still in seconds. [default: 0 for a scene, the last row for a CSV]",
        ),
    ] = None,
    start: Annotated[
        float | None,
        typer.Option("--from", metavar="S", help="Start time of a film. [default: the first row]"),
    ] = None,
    until: Annotated[
        float | None,
        typer.Option(
            "--until",
            metavar="S",
            help="End time of a film, required for a scene. [default: the last row]",
        ),
    ] = None,
    steps: StepsOption = None,
    duration: DurationOption = None,
    every: Annotated[
        float | None,
        typer.Option(
            "--every",
            metavar="S",
            help="Time between two pictures of a film. [default: for 25 pictures a second]",
        ),
    ] = None,
    speed: Annotated[
        float,
        typer.Option("--speed", help="Seconds of the scene in a second of the film."),
    ] = 1.0,
    camera: Annotated[
        str,
        typer.Option(
            "--camera",
            metavar="VIEW",
            help="oblique, front, side, top, or YAW,PITCH[,DISTANCE] in degrees and metres: yaw 0 "
            "looks along +y, 90 from +x; pitch is the angle above the horizon.",
        ),
    ] = "oblique",
    target: Annotated[
        str | None,
        typer.Option(
            "--target",
            metavar="X,Y,Z",
            help="The point in the middle of the picture [m]. [default: frame all that moves]",
        ),
    ] = None,
    size: Annotated[
        str, typer.Option("--size", metavar="WxH", help="Width and height in pixels.")
    ] = "960x720",
    scene: Annotated[
        str | None,
        typer.Option(
            "--scene",
            metavar="FILE",
            help="The scene of a CSV. [default: the one that its .meta.json names]",
        ),
    ] = None,
    simulates: Annotated[
        bool,
        typer.Option(
            "--simulate",
            help="Where a CSV lacks columns that pictures need, simulate its scene again.",
        ),
    ] = False,
    max_seconds: SecondsOption = None,
    max_memory: MemoryOption = None,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
    quiet: QuietOption = False,
) -> None:
    """Draw a scene or a recorded run, as a still or a film, without a display.

    A scene is simulated up to the time that is shown. A CSV is shown as it was recorded; it must
    have joint_angles, base_pose of free bases, and pose of free objects, or --simulate is needed.
    """
    budget = budget_of(max_seconds, max_memory)
    access = access_of(allow_outside, package)
    written = output or f"{Path(source).stem}{STILL}"
    kind = _kind_of(written)
    timing = Timing(kind != STILL, at, start, until, steps, duration, every, speed)
    look = look_of(camera, target, size, kind == ".mp4")
    is_csv = render_source.is_recording(source)
    for option, is_given in (("--scene", scene is not None), ("--simulate", simulates)):
        require(is_csv or not is_given, option, f"it is for a CSV, and {source} is not one")
    timing.check_options(is_csv)
    if timing.is_film:
        _require_encoder(timing)
    output_files.refuse_unwritable(written)
    if is_csv:
        again = partial(render_simulation.simulated_again, timing, budget) if simulates else None
        document, recording = render_source.recorded(source, scene, sets or [], access, again)
        refuse_overwriting(document, written)
        times = timing.frame_times(recording)
    else:
        document, found = render_source.read_scene(source, sets or [], access)
        refuse_overwriting(document, written)
        recording, times = render_simulation.simulated_for(document, found, timing, budget)
    drawn = _pictures(recording, times, look, budget)
    output_files.write_atomically(written, _encoded(drawn, look, timing, kind))
    if not quiet:
        terminal.print_message(f"{written}: {_summary(recording, times, look, timing)}")


def _kind_of(written: str) -> str:
    from somo_cli.picture import film

    kind = Path(written).suffix.lower()
    known = (STILL, *film.KINDS)
    message = f"{written} must end in one of {', '.join(known)}"
    require(kind in known, "--output", message)
    return kind


def _require_encoder(timing: Timing) -> None:
    from somo_cli.picture import film

    film.require()
    assert timing.rate, "checked before anything is simulated"


def _pictures(
    recording: "RecordedMotion",
    times: Sequence[float],
    look: "PictureSettings",
    budget: Budget,
) -> "Iterator[Array]":
    from somo_cli.picture.draw import pictures

    with terminal.progress(len(times), "drawing", budget) as advance:
        for number, picture in enumerate(pictures(recording, times, look), start=1):
            advance(number)
            yield picture


def _encoded(drawn: "Iterator[Array]", look: "PictureSettings", timing: Timing, kind: str) -> bytes:
    if timing.is_film:
        from somo_cli.picture import film

        return film.encode(drawn, look.size, timing.rate, kind)
    from somo_cli.picture.png import png

    return png(next(drawn))


def _summary(
    recording: "RecordedMotion", times: Sequence[float], look: "PictureSettings", timing: Timing
) -> str:
    from somo_cli.picture.draw import tile_edge

    width, height = look.size
    square = tile_edge(recording, times)
    ground = "" if square is None else f", squares of {square:g} m"
    if not timing.is_film:
        return f"{width} x {height} pixels, at {times[0]:.9g} s{ground}"
    span = f"{len(times)} pictures from {times[0]:.9g} s to {times[-1]:.9g} s"
    return f"{span}, {float(timing.rate):g} a second, {width} x {height} pixels{ground}"
