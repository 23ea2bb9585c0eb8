"""Check the start of a motion, its repetition and its point `about`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem, Span
from somo_cli.scene.prescribed_motion import component_signals

COMPONENTS_AND_UNITS = {"translation": ("x, y, z", "m"), "rotation": ("roll, pitch, yaw", "rad")}
DISPLACEMENT_TOLERANCE = 1e-12  # m and rad: displacement at time zero that is rounding

PlaceOf = Callable[[int], Span]
"""Takes the index of a waypoint or row; returns its place."""


def pose_problems(
    motion: Mapping[str, Any], part: str, points: Sequence[Sequence[float]], place: PlaceOf
) -> Iterator[Problem]:
    """Yield the errors of the pose at time zero and, if the motion repeats, at its end.

    `points` are [time, numbers]: three, or the four of a quaternion.
    """
    problems = list(_period_problems(motion, points, place)) if motion.get("repeat") else []
    yield from problems
    if not problems and motion.get("frame") != "world":
        yield from _start_problems(motion, part, points, place)


def _period_problems(
    motion: Mapping[str, Any], points: Sequence[Sequence[float]], place: PlaceOf
) -> Iterator[Problem]:
    first, last = list(points[0]), list(points[-1])
    if first[0] != 0:
        message = f"a repeated motion starts at time 0, not {first[0]} s"
        yield Problem(place(0), message, f"start with {[0, *_no_motion(points)]}")
    if last[0] <= 0:
        message = f"a repeated motion has a period of {last[0]} s"
        hint = "the time of the last waypoint is the period"
        yield Problem(place(len(points) - 1), message, hint)
    elif last[1:] != first[1:]:
        message = f"a repeated motion ends where it starts, at {first[1:]}"
        hint = f"end with {[last[0], *first[1:]]}"
        yield Problem(place(len(points) - 1), f"{message}, not {last[1:]}", hint)


def _start_problems(
    motion: Mapping[str, Any], part: str, points: Sequence[Sequence[float]], place: PlaceOf
) -> Iterator[Problem]:
    start = next((list(point[1:]) for point in points if point[0] == 0), None)
    if start is None:
        interpolation, repeat = motion.get("interpolation", "cubic"), bool(motion.get("repeat"))
        start = [one.at(0.0) for one in component_signals(points, interpolation, repeat)]
    if max(map(abs, start[:3])) <= DISPLACEMENT_TOLERANCE:
        return
    shown = ", ".join(f"{value:.3g}" for value in start)
    unit = " " + COMPONENTS_AND_UNITS[part][1] if len(start) == 3 else ""
    hint = f"begin with {[0, *_no_motion(points)]}, and change the start pose instead"
    if not COMPONENTS_AND_UNITS.keys() & motion.keys():
        hint = "set frame: world if these are poses in the world, or begin with no displacement"
    yield Problem(
        place(0),
        f"at time 0 the {part} is [{shown}]{unit}, and the motion starts where position and rpy "
        "say",
        hint,
    )


def _no_motion(points: Sequence[Sequence[float]]) -> list[float]:
    return [0, 0, 0] if len(points[0]) == 4 else [0, 0, 0, 1]


def about_problems(
    document: Document, at: Pointer, motion: Mapping[str, Any], has_rotation: bool
) -> Iterator[Problem]:
    """Yield an error if the motion at `at` says about what it turns, and that has no meaning."""
    if "about" not in motion or (has_rotation and motion.get("frame") != "world"):
        return
    why = "with frame: world" if has_rotation else "without a rotation"
    place = document.span((*at, "about"), key=True)
    yield Problem(place, f"about has no meaning {why}", "leave it out")
