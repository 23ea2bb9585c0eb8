"""Faults of meaning in a scene, each with its place; those of its definitions come along."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.document.validate import faults_of_shape, soundness
from somo_cli.manipulator import meaning as manipulator_meaning
from somo_cli.manipulator import read as manipulator_read
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import compile_sound
from somo_cli.manipulator.meaning import IsSound
from somo_cli.problems import Pointer, Problem
from somo_cli.simulation.scene import name_of, per_joint


def faults(document: Document) -> tuple[Problem, ...]:
    """Return every error and warning about a scene and the definitions in it."""
    shape = faults_of_shape(document, "scene")
    problems = [fault.problem for fault in shape]
    is_sound = soundness(shape)
    data = document.data
    manipulators = data.get("manipulators") if isinstance(data, Mapping) else None
    if isinstance(manipulators, list):
        for index, item in enumerate(manipulators):
            if isinstance(item, Mapping):
                problems.extend(_manipulator_faults(document, index, item, is_sound))
        problems.extend(_name_faults(document, manipulators, is_sound))
        problems.extend(_scale_faults(document, manipulators, is_sound))
    return tuple(problems)


def _name_faults(
    document: Document, manipulators: list[Any], is_sound: IsSound
) -> Iterator[Problem]:
    seen: set[str] = set()
    for index, item in enumerate(manipulators):
        at: Pointer = ("manipulators", index)
        names = (*at, "name"), (*at, "definition", "manipulator_name")
        if not is_sound(names[0]) or not isinstance(item, Mapping):
            continue
        if "name" not in item and not _has_name(item):
            continue
        name = str(item["name"]) if "name" in item else name_of(item)
        if name in seen:
            place = document.span((*at, "name") if "name" in item else (*at, "definition"))
            yield Problem(
                place,
                f"two manipulators are called '{name}'",
                "give each manipulator a name of its own",
            )
        seen.add(name)


def _has_name(item: Mapping[str, Any]) -> bool:
    definition = item.get("definition")
    return isinstance(definition, Mapping) and "manipulator_name" in definition


def _scale_faults(
    document: Document, manipulators: list[Any], is_sound: IsSound
) -> Iterator[Problem]:
    """Refuse to choose between definitions that ask for different scales."""
    data = document.data
    if not isinstance(data, Mapping) or "world_scale" in data:
        return
    first = None
    for index, item in enumerate(manipulators):
        at: Pointer = ("manipulators", index, "definition")
        is_mapping = isinstance(item, Mapping) and isinstance(item.get("definition"), Mapping)
        if not is_mapping or not is_sound((*at, "world_scale")):
            continue
        scale = manipulator_read.world_scale(document, at)
        if index > 0 and scale != first:
            yield Problem(
                document.span(at),
                "the definitions have different world scales",
                "give the scene a world_scale of its own",
            )
        first = scale if index == 0 else first


def _manipulator_faults(
    document: Document, index: int, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    at: Pointer = ("manipulators", index)
    of_definition = list(manipulator_meaning.faults(document, (*at, "definition"), is_sound))
    yield from of_definition
    base = data.get("base", "static")
    for key in ("linear_velocity", "angular_velocity"):
        if key in data and base == "static":
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} is for a base that can move",
                "set base: free",
            )
    actuation = data.get("actuation")
    entries = actuation if isinstance(actuation, list) else []
    for number, entry in enumerate(entries):
        place = (*at, "actuation", number)
        if isinstance(entry, Mapping) and is_sound(place):
            yield from _torque_faults(document, place, entry)
    is_compilable = is_sound((*at, "definition")) and "definition" in data
    if is_compilable and all(problem.severity == "warning" for problem in of_definition):
        compiled = compile_sound(document, (*at, "definition"), ())
        yield from _start_faults(document, at, data, compiled.chain, is_sound)
        if is_sound((*at, "actuation")):
            yield from _reference_faults(document, (*at, "actuation"), entries, compiled.chain)


def _torque_faults(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    if ("torque" in data) == ("waypoints" in data):
        message = "give either torque or waypoints" + (", not both" if "torque" in data else "")
        yield Problem(document.span(at, key=True), message)
        return
    if "torque" in data:
        for key in ("interpolation", "repeat"):
            if key in data:
                yield Problem(
                    document.span((*at, key), key=True), f"{key} has no meaning without waypoints"
                )
        return
    points = data["waypoints"]
    for number in range(1, len(points)):
        if points[number][0] <= points[number - 1][0]:
            yield Problem(
                document.span((*at, "waypoints", number)),
                f"time {points[number][0]} s does not come after {points[number - 1][0]} s",
            )
    if data.get("repeat"):
        yield from _repeat_faults(document, at, data, points)


def _repeat_faults(
    document: Document, at: Pointer, data: Mapping[str, Any], points: list[Any]
) -> Iterator[Problem]:
    if points[-1][0] <= 0 or points[0][0] < 0:
        yield Problem(
            document.span((*at, "waypoints")),
            "repeated way-points must lie between time 0 and the time of the last one, "
            "which is the period",
        )
    is_cubic = data.get("interpolation") == "cubic"
    if is_cubic and (points[0][1] != points[-1][1] or points[0][0] != 0):
        yield Problem(
            document.span((*at, "waypoints")),
            "a repeated cubic must start at time 0 and end at the torque it starts with",
        )


def _start_faults(
    document: Document, at: Pointer, data: Mapping[str, Any], chain: Chain, is_sound: IsSound
) -> Iterator[Problem]:
    count = len(chain.joints)
    for key in ("initial_angles", "initial_rates"):
        values = data.get(key)
        if is_sound((*at, key)) and isinstance(values, list) and len(values) != count:
            yield Problem(
                document.span((*at, key)),
                f"{key} has {len(values)} values for {count} joints",
                "give one value per joint, base to tip, or one number for all",
            )
            return
    if not is_sound((*at, "initial_angles")):
        return
    for joint, angle in zip(
        chain.joints, per_joint(data.get("initial_angles", 0), count), strict=True
    ):
        if joint.is_limited and not joint.lower <= angle <= joint.upper:
            key_or_item = "initial_angles" if "initial_angles" in data else "definition"
            yield Problem(
                document.span((*at, key_or_item)),
                f"joint '{joint.name}' starts at {angle:g} rad, outside its limits "
                f"[{joint.lower:g}, {joint.upper:g}]",
                "set initial_angles",
            )


def _reference_faults(
    document: Document, at: Pointer, entries: list[Any], chain: Chain
) -> Iterator[Problem]:
    axes: dict[int, set[int]] = {}
    for joint in chain.joints:
        axes.setdefault(joint.actuator, set()).add(joint.channel)
    seen: set[tuple[int, int]] = set()
    for number, entry in enumerate(entries):
        actuator, axis = int(entry["actuator"]), int(entry["axis"])
        place = document.span((*at, number, "actuator"))
        if actuator not in axes:
            known = ", ".join(map(str, sorted(axes)))
            yield Problem(place, f"there is no actuator {actuator}", f"the actuators are {known}")
        elif axis not in axes[actuator]:
            known = ", ".join(map(str, sorted(axes[actuator])))
            yield Problem(
                document.span((*at, number, "axis")),
                f"actuator {actuator} has no axis {axis}",
                f"its axes are {known}",
            )
        elif (actuator, axis) in seen:
            message = f"actuator {actuator}, axis {axis} is driven twice"
            yield Problem(place, message, "keep one entry, or add the torques")
        seen.add((actuator, axis))

