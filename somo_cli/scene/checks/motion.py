"""Faults of meaning in the motion of a base or an object, each with its place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.prescribed_motion import vector_signal

_COMPONENTS_AND_UNITS = {"translation": ("x, y, z", "m"), "rotation": ("roll, pitch, yaw", "rad")}
DISPLACEMENT_TOLERANCE = 1e-12  # m and rad: displacement at time zero that is rounding


def base_motion_problems(
    document: Document, at: Pointer, motion: Mapping[str, Any], base: str
) -> Iterator[Problem]:
    """Yield every fault of the motion at `at` of a manipulator with such a base."""
    if base != "constrained":
        yield Problem(
            document.span(at, key=True),
            f"motion is for a base that a constraint holds, this one is {base}",
            "set base: constrained, or leave it out",
        )
    yield from motion_problems(document, at, motion)


def motion_problems(
    document: Document, at: Pointer, motion: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield every fault of the motion at `at`, whatever it moves."""
    if not any(part in motion for part in _COMPONENTS_AND_UNITS):
        yield Problem(
            document.span(at, key=True),
            "missing translation or rotation",
            "give a translation [s, m, m, m], a rotation [s, rad, rad, rad], or both",
        )
    if "about" in motion and "rotation" not in motion:
        yield Problem(
            document.span((*at, "about"), key=True),
            "about has no meaning without a rotation",
            "leave it out",
        )
    for part in _COMPONENTS_AND_UNITS:
        if part in motion:
            problems = list(_time_order_problems(document, at, part, motion[part]))
            yield from problems or _pose_problems(document, at, part, motion)


def _time_order_problems(
    document: Document, at: Pointer, part: str, points: Sequence[Sequence[float]]
) -> Iterator[Problem]:
    for number in range(1, len(points)):
        if points[number][0] <= points[number - 1][0]:
            yield Problem(
                document.span((*at, part, number)),
                f"time {points[number][0]} s does not come after {points[number - 1][0]} s",
                f"waypoints are [time, {_COMPONENTS_AND_UNITS[part][0]}], and each has a later "
                "time than the one before",
            )


def _pose_problems(
    document: Document, at: Pointer, part: str, motion: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield faults of where the motion is at time zero and, if it repeats, at its end."""
    points = motion[part]
    first, last = (*at, part, 0), (*at, part, len(points) - 1)
    if motion.get("repeat"):
        found = False
        if points[0][0] != 0:
            message = f"a repeated motion starts at time 0, not {points[0][0]} s"
            yield Problem(document.span(first), message, f"start with {_zero_waypoint(0)}")
            found = True
        if points[-1][0] <= 0:
            message = f"a repeated motion has a period of {points[-1][0]} s"
            hint = "the time of the last waypoint is the period"
            yield Problem(document.span(last), message, hint)
            found = True
        elif points[-1][1:] != points[0][1:]:
            message = f"a repeated motion ends where it starts, at {points[0][1:]}"
            hint = f"end with {[points[-1][0], *points[0][1:]]}"
            yield Problem(document.span(last), f"{message}, not {points[-1][1:]}", hint)
            found = True
        if found:
            return
    signals = vector_signal(
        points, motion.get("interpolation", "cubic"), bool(motion.get("repeat"))
    )
    start = [one.at(0.0) for one in signals]
    if max(map(abs, start)) > DISPLACEMENT_TOLERANCE:
        shown = ", ".join(f"{value:.3g}" for value in start)
        yield Problem(
            document.span(first),
            f"at time 0 the {part} is [{shown}] {_COMPONENTS_AND_UNITS[part][1]}, and the motion "
            "starts where position and rpy say",
            f"begin with {_zero_waypoint(0)}, and change the start pose instead",
        )


def _zero_waypoint(time: float) -> list[float]:
    return [time, 0, 0, 0]
