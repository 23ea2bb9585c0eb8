"""Check the objects of a scene, beyond what the schema checks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem, has_errors
from somo_cli.scene.checks import motion as motion_checks
from somo_cli.scene.checks import object_shapes as object_shapes_checks
from somo_cli.scene.checks import placement as placement_checks
from somo_cli.scene.extents import MAX_RELATIVE_DEPTH, min_height
from somo_cli.scene.reader import manipulator_name_of
from somo_cli.scene.rigid_object import read_object

_KEYS_SETTING_HEIGHT = {"motion", "place"}
_VELOCITY_KEYS = ("linear_velocity", "angular_velocity")


def object_problems(
    document: Document, is_sound: IsSound, channel_counts: Mapping[str, int | None]
) -> Iterator[Problem]:
    """Yield the errors and warnings about all objects of a scene that fit the schema.

    `channel_counts` has the number of channels of each trajectory, None if it is unknown.
    """
    scene = document.data
    objects = scene.get("objects") if isinstance(scene, Mapping) else None
    if isinstance(objects, list):
        yield from placement_checks.placement_problems(document, objects, is_sound)
    names = _names_of_manipulators(scene)
    for index, item in enumerate(objects if isinstance(objects, list) else ()):
        at: Pointer = ("objects", index)
        if not isinstance(item, Mapping) or not is_sound(at):
            continue
        own_problems = list(_object_problems(document, at, item, channel_counts))
        yield from own_problems
        if item["name"] in names:
            message = f"another manipulator or object is called '{item['name']}'"
            yield Problem(document.span((*at, "name")), message, "give each a different name")
        names.add(item["name"])
        if not has_errors(own_problems) and isinstance(scene, Mapping) and is_sound(("ground",)):
            yield from _ground_problems(document, at, item, scene.get("ground"))


def _names_of_manipulators(scene: object) -> set[str]:
    data: Any = scene
    manipulators = data.get("manipulators") if isinstance(data, Mapping) else None
    names: set[str] = set()
    for item in manipulators if isinstance(manipulators, list) else ():
        try:
            names.add(manipulator_name_of(item))
        except (KeyError, TypeError, AttributeError):
            continue  # the checks of manipulators report it
    return names


def _object_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    yield from object_shapes_checks.object_shape_problems(document, at, data)
    is_fixed, has_motion = data.get("fixed", False), "motion" in data
    if has_motion:
        yield from motion_checks.motion_problems(document, at, data, channel_counts)
    if has_motion and is_fixed:
        message = "motion is for an object that can move, and this one is fixed"
        hint = "leave it out, or set fixed: false"
        yield Problem(document.span((*at, "motion"), key=True), message, hint)
    if not is_fixed and not has_motion:
        return
    state, hint = (
        ("is fixed", "set fixed: false")
        if is_fixed
        else ("has a prescribed motion", "leave out its motion")
    )
    for key in _VELOCITY_KEYS:
        if key in data:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} is for a free object, and this one {state}",
                f"leave it out, or {hint}",
            )


def _ground_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], ground: Any
) -> Iterator[Problem]:
    if ground is None or not data.get("collides", True):
        return
    if data.get("fixed", False) or not _KEYS_SETTING_HEIGHT.isdisjoint(data):
        # an object with a prescribed pose does not collide with the ground, and `place` sets the
        # height from the shape
        return
    one = read_object(data)
    low = min(min_height(shape, one.pose) for shape in one.chain.links[0].shapes)
    depth = float(ground.get("height", 0)) - low
    if depth > MAX_RELATIVE_DEPTH * one.chain.length:
        yield Problem(
            document.span((*at, "position")),
            f"object '{one.name}' starts {depth:.3g} m inside the ground",
            "raise it with position, or lower the ground with its height",
        )
