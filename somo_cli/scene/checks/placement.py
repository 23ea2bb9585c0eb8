"""Check what objects stand on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem, did_you_mean
from somo_cli.scene.contact_surface import GROUND_NAME


def placement_problems(
    document: Document, objects: list[Any], is_sound: IsSound
) -> Iterator[Problem]:
    """Yield an error for each unknown support and for each circle of objects on each other."""
    names = [item["name"] for item in objects if isinstance(item, Mapping) and "name" in item]
    has_ground = isinstance(document.data, Mapping) and "ground" in document.data
    on: dict[str, str] = {}
    for index, item in enumerate(objects):
        at: Pointer = ("objects", index, "place", "on")
        if not isinstance(item, Mapping) or "place" not in item or not is_sound(at[:2]):
            continue
        name = item["place"]["on"]
        if name in names:
            on[item["name"]] = name
        elif name != GROUND_NAME:
            yield Problem(
                document.span(at),
                f"there is no object '{name}'",
                _known_objects_hint(name, names, has_ground),
            )
        elif not has_ground:
            message = "there is no ground to stand on"
            yield Problem(document.span(at), message, "add ground: {}, or name an object")
    yield from _circular_placements(document, objects, on)


def _known_objects_hint(name: str, names: list[str], has_ground: bool) -> str:
    known = [str(one) for one in ((GROUND_NAME, *names) if has_ground else names)]
    return did_you_mean(str(name), known, 0.7) or f"there are {', '.join(known)}"


def _circular_placements(
    document: Document, objects: list[Any], on: Mapping[str, str]
) -> Iterator[Problem]:
    """Yield one error for each circle, at its first object in the file."""
    reported: set[str] = set()
    for index, item in enumerate(objects):
        start = str(item.get("name")) if isinstance(item, Mapping) else ""
        circle = [] if start in reported else _circle_from(start, on)
        if circle:
            reported.update(circle)
            yield _circle_problem(document, index, circle)


def _circle_from(start: str, on: Mapping[str, str]) -> list[str]:
    """Return `start` and the objects below it if the last stands on `start`, else nothing."""
    chain = [start]
    while chain[-1] in on and on[chain[-1]] not in chain:
        chain.append(on[chain[-1]])
    return chain if on.get(chain[-1]) == start else []


def _circle_problem(document: Document, index: int, circle: list[str]) -> Problem:
    if len(circle) == 1:
        message = f"'{circle[0]}' cannot stand on itself"
    else:
        names = " on ".join(f"'{name}'" for name in (*circle, circle[0]))
        message = f"objects stand on each other in a circle: {names}"
    place = document.span(("objects", index, "place", "on"))
    return Problem(place, message, "let one of them stand on something else")
