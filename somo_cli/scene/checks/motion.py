"""Check the prescribed motion of a base or an object."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem, Span
from somo_cli.scene.checks.motion_file import motion_file_problems
from somo_cli.scene.checks.motion_start import (
    COMPONENTS_AND_UNITS,
    about_problems,
    pose_problems,
)
from somo_cli.scene.checks.motion_trajectory import motion_trajectory_problems

_FILE_KEYS = ("file", "trajectory")
_START_KEYS = ("position", "rpy", "place")


def base_motion_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    """Yield the errors of the motion of the manipulator `data` at `at`."""
    base = str(data.get("base", "static"))
    if base != "constrained":
        yield Problem(
            document.span((*at, "motion"), key=True),
            f"motion is for a constrained base, and this one is {base}",
            "set base: constrained, or leave it out",
        )
    yield from motion_problems(document, at, data, channel_counts)


def motion_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    """Yield the errors of the motion of the manipulator or object `data` at `at`.

    `channel_counts` has the number of channels of each trajectory, None if it is unknown.
    """
    motion, place = data["motion"], (*at, "motion")
    kinds = [key for key in (*_FILE_KEYS, *COMPONENTS_AND_UNITS) if key in motion]
    if any(key in motion for key in _FILE_KEYS) and len(kinds) > 1:
        message = f"{kinds[1]} has no meaning beside {kinds[0]}, which is the whole motion"
        yield Problem(document.span((*place, kinds[1]), key=True), message, "leave one out")
        return
    if motion.get("frame") == "world":
        yield from _start_key_problems(document, at, data)
    if "file" in motion:
        yield from motion_file_problems(document, place, motion)
    elif "trajectory" in motion:
        yield from motion_trajectory_problems(document, place, motion, channel_counts)
    else:
        yield from _waypoint_problems(document, place, motion)


def _start_key_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    for key in _START_KEYS:
        if key in data:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} has no meaning beside a motion with frame: world, which says where it "
                "starts",
                "leave it out, or set frame: start",
            )


def _waypoint_problems(
    document: Document, at: Pointer, motion: Mapping[str, Any]
) -> Iterator[Problem]:
    if not any(part in motion for part in COMPONENTS_AND_UNITS):
        yield Problem(
            document.span(at, key=True),
            "missing translation or rotation",
            "give a translation [s, m, m, m], a rotation [s, rad, rad, rad], or both, or a file",
        )
    if "frame" in motion:
        message = "frame is for a motion from a file or a trajectory: waypoints are from the start"
        yield Problem(document.span((*at, "frame"), key=True), message, "leave it out")
    yield from about_problems(document, at, motion, "rotation" in motion)
    for part in COMPONENTS_AND_UNITS:
        if part in motion:
            problems = list(_time_order_problems(document, at, part, motion[part]))
            place = partial(_place_of, document, (*at, part))
            yield from problems or pose_problems(motion, part, motion[part], place)


def _place_of(document: Document, at: Pointer, index: int) -> Span:
    return document.span((*at, index))


def _time_order_problems(
    document: Document, at: Pointer, part: str, points: Sequence[Sequence[float]]
) -> Iterator[Problem]:
    for number in range(1, len(points)):
        if points[number][0] <= points[number - 1][0]:
            yield Problem(
                document.span((*at, part, number)),
                f"time {points[number][0]} s does not come after {points[number - 1][0]} s",
                f"waypoints are [time, {COMPONENTS_AND_UNITS[part][0]}], and each needs a later "
                "time than the one before",
            )
