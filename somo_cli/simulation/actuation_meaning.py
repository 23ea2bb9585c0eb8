"""Faults of what drives an axis of an actuator: torque, pressure or way-points of either."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import Compiled
from somo_cli.problems import Pointer, Problem
from somo_cli.simulation.scene import AmbiguousPressure, torque_per_pressure
from somo_cli.simulation.waypoint_meaning import waypoint_faults

_CONSTANTS = ("torque", "pressure")


def faults(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield the faults of the entry `data` at `at` that need no look at the manipulator."""
    given = [key for key in (*_CONSTANTS, "waypoints") if key in data]
    if not given:
        yield Problem(
            document.span(at, key=True),
            "missing torque, pressure or waypoints",
            "give a constant torque or pressure, or waypoints: [[time, torque], ...]",
        )
        return
    if len(given) > 1:
        yield Problem(
            document.span((*at, given[-1]), key=True),
            f"both {given[0]} and {given[-1]} are given",
            f"{given[0]} holds all the time, waypoints are [time, torque] pairs: keep one of them"
            if given[-1] == "waypoints"
            else "keep one of them",
        )
        return
    if given[0] != "waypoints":
        for key in ("interpolation", "repeat", "input"):
            if key in data:
                yield Problem(
                    document.span((*at, key), key=True),
                    f"{key} has no meaning beside a constant {given[0]}",
                    f"leave it out, or give waypoints in place of {given[0]}",
                )
        return
    unit = " Pa" if data.get("input") == "pressure" else " N·m"
    yield from waypoint_faults(document, at, data, data.get("input", "torque"), unit)


def faults_of_axes(
    document: Document, at: Pointer, entries: list[Any], compiled: Compiled
) -> Iterator[Problem]:
    """Yield the faults of entries at `at` that name what the manipulator does not have."""
    axes = _axes(compiled.chain)
    seen: set[tuple[int, int]] = set()
    for number, entry in enumerate(entries):
        actuator, axis = int(entry["actuator"]), int(entry["axis"])
        place = document.span((*at, number, "actuator"))
        if actuator not in axes:
            hint = _known("actuator", axes)
            yield Problem(place, f"there is no actuator {actuator}", hint)
        elif axis not in axes[actuator]:
            message = f"actuator {actuator} has no axis {axis}"
            hint = _known("axis", axes[actuator])
            yield Problem(document.span((*at, number, "axis")), message, hint)
        elif (actuator, axis) in seen:
            message = f"actuator {actuator}, axis {axis} is driven twice"
            yield Problem(place, message, "keep one entry, or add the torques")
        else:
            yield from _pressure_faults(document, (*at, number), entry, compiled)
        seen.add((actuator, axis))


def _pressure_faults(
    document: Document, at: Pointer, data: Mapping[str, Any], compiled: Compiled
) -> Iterator[Problem]:
    key = "pressure" if "pressure" in data else "input"
    if key == "input" and data.get("input") != "pressure":
        return
    actuator, axis = int(data["actuator"]), int(data["axis"])
    joints = f"the joints of actuator {actuator}, axis {axis}"
    try:
        is_known = torque_per_pressure(compiled.definition, actuator, axis) is not None
    except AmbiguousPressure:
        message = f"{joints} differ in torque_per_pressure"
        yield Problem(document.span((*at, key), key=True), message, "give all of them the same")
        return
    if not is_known:
        yield Problem(
            document.span((*at, key), key=True),
            f"{joints} have no torque_per_pressure",
            "give it in their joint definition, or drive them by torque; "
            "somo calibrate torque finds it",
        )


def _axes(chain: Chain) -> Mapping[int, set[int]]:
    axes: dict[int, set[int]] = {}
    for joint in chain.joints:
        axes.setdefault(joint.actuator, set()).add(joint.channel)
    return axes


def _known(thing: str, numbers: Iterable[int]) -> str:
    known = [str(number) for number in sorted(numbers)]
    if len(known) == 1:
        return f"the only {thing} is {known[0]}"
    return f"the {'axes' if thing == 'axis' else thing + 's'} are {', '.join(known)}"
