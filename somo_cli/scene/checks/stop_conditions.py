"""Check the conditions that end a run, beyond what the schema checks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem, did_you_mean
from somo_cli.scene.stop_conditions import AXIS_NAMES

_CONDITION_FORMS = (
    "give time: 2.0, or object: NAME and leaves: {z: [0.02, 0.5]}, or at_rest: {for: 0.5}, "
    "or findings: any"
)


def stop_condition_problems(document: Document, is_sound: IsSound) -> Iterator[Problem]:
    """Yield the errors of all stop conditions of a scene that fit the schema."""
    scene = document.data
    if not isinstance(scene, Mapping):
        return
    items, declared = scene.get("stop"), scene.get("objects")
    objects = [one for one in _as_list(declared) if isinstance(one, Mapping) and "name" in one]
    for index, item in enumerate(_as_list(items)):
        at: Pointer = ("stop", index)
        if isinstance(item, Mapping) and is_sound(at):
            yield from _condition_problems(document, at, item, objects, is_sound(("objects",)))


def _as_list(value: object) -> Sequence[Any]:
    return value if isinstance(value, list) else ()


def _condition_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    objects: Sequence[Mapping[str, Any]],
    are_objects_sound: bool,
) -> Iterator[Problem]:
    kinds = [key for key in ("time", "leaves", "at_rest", "findings") if key in data]
    if len(kinds) > 1:
        message = f"{' and '.join(kinds)} are {len(kinds)} conditions in one entry"
        yield Problem(document.span((*at, kinds[1]), key=True), message, "give each its own entry")
        return
    if "object" in data and kinds not in ([], ["leaves"]):
        message = f"object has no meaning beside {kinds[0]}"
        yield Problem(document.span((*at, "object"), key=True), message, "leave it out")
        return
    if not kinds:
        missing = "leaves, the box of the object" if "object" in data else "a condition"
        yield Problem(document.span(at, key=True), f"missing {missing}", _CONDITION_FORMS)
        return
    if kinds != ["leaves"]:
        return
    empty = list(_empty_box_problems(document, at, data["leaves"]))
    yield from empty
    if "object" not in data:
        message = "missing object: the name of the object that leaves the box"
        yield Problem(document.span(at, key=True), message, _known_objects_hint(objects))
    elif are_objects_sound:
        yield from _stopped_object_problems(document, at, data, objects, bool(empty))


def _empty_box_problems(
    document: Document, at: Pointer, box: Mapping[str, Sequence[float]]
) -> Iterator[Problem]:
    for axis in AXIS_NAMES:
        if axis in box and not box[axis][0] < box[axis][1]:
            low, high = box[axis]
            yield Problem(
                document.span((*at, "leaves", axis)),
                f"the range from {low:g} to {high:g} is empty",
                "give the lower bound first, then the higher one",
            )


def _stopped_object_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    objects: Sequence[Mapping[str, Any]],
    is_empty: bool,
) -> Iterator[Problem]:
    name = str(data["object"])
    rigid_object = next((one for one in objects if str(one["name"]) == name), None)
    place = document.span((*at, "object"))
    if rigid_object is None:
        known = [str(one["name"]) for one in objects]
        hint = did_you_mean(name, known) or _known_objects_hint(objects)
        yield Problem(place, f"there is no object '{name}'", hint)
        return
    if rigid_object.get("fixed", False):
        yield Problem(place, f"'{name}' is fixed, so it never leaves", "name one that can move")
        return
    if "position" not in rigid_object or "place" in rigid_object or is_empty:
        return
    for axis, value in zip(AXIS_NAMES, rigid_object["position"], strict=True):
        low, high = data["leaves"].get(axis, (value, value))
        if not low <= value <= high:
            yield Problem(
                document.span((*at, "leaves", axis)),
                f"'{name}' starts outside the box, at {axis} = {value:g} m: the run would end "
                "before its first step",
                "widen the box",
            )


def _known_objects_hint(objects: Sequence[Mapping[str, Any]]) -> str:
    names = ", ".join(str(one["name"]) for one in objects)
    return f"the objects are {names}" if names else "the scene has no objects"
