"""Check waypoints over time, of torques, pressures or factors of loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem


def waypoint_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], quantity: str, unit: str
) -> Iterator[Problem]:
    """Yield the errors of the waypoints of the entry `data` at `at`, and of their repetition.

    Waypoints are [time, quantity] pairs; messages print `unit`, such as " N·m", after a value.
    """
    points = data["waypoints"]
    for number in range(1, len(points)):
        if points[number][0] <= points[number - 1][0]:
            yield Problem(
                document.span((*at, "waypoints", number)),
                f"time {points[number][0]} s does not come after {points[number - 1][0]} s",
                f"waypoints are [time, {quantity}], and each needs a later time than the one "
                "before",
            )
    if data.get("repeat"):
        yield from _repeat_problems(document, at, data, quantity, unit)


def _repeat_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], quantity: str, unit: str
) -> Iterator[Problem]:
    points = data["waypoints"]
    first, last = (*at, "waypoints", 0), (*at, "waypoints", len(points) - 1)
    if points[0][0] < 0:
        message = f"repeated waypoints start at time {points[0][0]} s, before 0"
        yield Problem(document.span(first), message, "start at time 0 or later")
    if points[-1][0] <= 0:
        message = f"repeated waypoints have a period of {points[-1][0]} s"
        hint = "the time of the last waypoint is the period"
        yield Problem(document.span(last), message, hint)
    if data.get("interpolation") != "cubic":
        return
    if points[0][0] > 0:
        message = f"repeated cubic waypoints must start at time 0, not {points[0][0]} s"
        yield Problem(document.span(first), message, "add a waypoint at time 0")
    if points[0][1] != points[-1][1]:
        yield Problem(
            document.span(last),
            f"repeated cubic waypoints must end with the {quantity} they start with, "
            f"{points[0][1]}{unit}, not {points[-1][1]}{unit}",
            f"end with [{points[-1][0]}, {points[0][1]}], or use interpolation: linear",
        )
