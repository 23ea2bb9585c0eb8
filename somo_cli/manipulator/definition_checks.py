"""Errors and warnings about a definition that a schema cannot express."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator.definition import MAXIMUM_JOINTS
from somo_cli.manipulator.link_checks import IsSound, link_problems
from somo_cli.manipulator.modulus_checks import modulus_problems
from somo_cli.manipulator.read import link_from
from somo_cli.manipulator.taper_checks import taper_problems
from somo_cli.problems import Pointer, Problem

LENGTH_TOLERANCE = 1e-6  # relative; 3 * 0.1 must equal 0.3


def definition_problems(document: Document, at: Pointer, is_sound: IsSound) -> Iterator[Problem]:
    """Yield the errors and warnings about the definition at a pointer.

    Parts in which the schema found errors are skipped.
    """
    data = document.at(at)
    if not isinstance(data, Mapping):
        return
    yield from _top_level_problems(document, at, data, is_sound)
    for key in ("base_definition", "tip_definition"):
        if isinstance(data.get(key), Mapping):
            yield from link_problems(document, (*at, key), is_sound)
    for index, _ in enumerate(_items(data.get("tip_definitions"))):
        yield from link_problems(document, (*at, "tip_definitions", index), is_sound)
    actuators = _items(data.get("actuator_definitions"))
    for index, _ in enumerate(actuators):
        yield from _actuator_problems(document, (*at, "actuator_definitions", index), is_sound)
    yield from _joint_count_problems(document, (*at, "actuator_definitions"), actuators, is_sound)


def _items(value: object) -> Sequence[Any]:
    return value if isinstance(value, list) else ()


def _top_level_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    actuators: Any = data.get("actuator_definitions")
    has_count = "n_act" in data and is_sound((*at, "n_act")) and isinstance(actuators, list)
    if has_count and data["n_act"] != len(actuators):
        yield Problem(
            document.span((*at, "n_act")),
            f"n_act is {data['n_act']}, but actuator_definitions has {len(actuators)}",
            f"leave n_act out, or set it to {len(actuators)}",
        )
    if data.get("tip_definition") and data.get("tip_definitions"):
        yield Problem(
            document.span((*at, "tip_definition"), key=True),
            "tip_definition and tip_definitions exclude each other",
            "put all the tips into tip_definitions",
        )
    if isinstance(data.get("urdf_filename"), str):
        yield from filename_problems(document, (*at, "urdf_filename"), data["urdf_filename"])


def filename_problems(document: Document, at: Pointer, filename: str) -> Iterator[Problem]:
    """Yield the problem of a `urdf_filename` that is not just a file name."""
    parts = filename.replace("\\", "/").split("/")
    hint = "give a name without a folder; choose the folder with -o"
    is_path = parts[0] in ("", "~") or ".." in parts or ":" in filename
    # "-" would be a stream or an option; a dot hides a file, and may be a shell's own
    is_name = filename.isprintable() and parts[-1] and not parts[-1].startswith((".", "-"))
    if is_path or not is_name:
        message = f"urdf_filename {filename!r} is not the name of a file"
        yield Problem(document.span(at), message, hint)
    elif len(parts) > 1:
        message = f"the folder in urdf_filename '{filename}' is ignored"
        yield Problem(document.span(at), message, hint, "warning")


def _actuator_problems(document: Document, at: Pointer, is_sound: IsSound) -> Iterator[Problem]:
    data = document.at(at)
    if not isinstance(data, Mapping):
        return
    joints = _items(data.get("joint_definitions"))
    for index, joint in enumerate(joints):
        if isinstance(joint, Mapping) and is_sound((*at, "joint_definitions", index)):
            yield from _joint_problems(document, (*at, "joint_definitions", index), joint)
    if isinstance(data.get("link_definition"), Mapping):
        yield from link_problems(document, (*at, "link_definition"), is_sound)
        yield from modulus_problems(document, at, data, is_sound)
    needed: tuple[Pointer, ...] = ((*at, "n_segments"), (*at, "planar_flag"))
    if "n_segments" in data and all(is_sound(pointer) for pointer in needed):
        yield from _count_problems(document, at, data, len(joints), is_sound)
        yield from _length_problems(document, at, data, is_sound)
    yield from _placement_problems(document, at, data, is_sound)
    yield from taper_problems(document, at, data, is_sound)


def _count_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], count: int, is_sound: IsSound
) -> Iterator[Problem]:
    if count == 0:
        return
    flag = data.get("planar_flag", 1 if count == 1 else 0)
    definitions = (*at, "joint_definitions")
    found = _count_error(flag, "planar_flag" in data, count, data["n_segments"])
    if found is not None:
        yield Problem(document.span(definitions, key=True), *found)
    elif flag == 2 and is_sound(definitions):
        yield from _axis_problems(document, definitions, data["joint_definitions"])


def _count_error(flag: object, is_given: bool, count: int, segments: int) -> tuple[str, str] | None:
    """Return message and hint if planar_flag does not allow `count` joint definitions."""
    if flag == 1 and count != 1:
        return (
            f"planar_flag 1 needs 1 joint definition, found {count}",
            "use planar_flag 0 for several axes, 2 for one definition per segment",
        )
    if flag == 0 and count not in (2, 3):
        default = "" if is_given else ", the default,"
        return (
            f"planar_flag 0{default} needs 2 or 3 joint definitions, found {count}",
            "use planar_flag 1 for a single joint definition, 2 for one per segment",
        )
    if flag == 2 and count != segments:
        return (
            f"planar_flag 2 needs one joint definition per segment, "
            f"found {count} for {segments} segments",
            "use planar_flag 1 for one joint definition, 0 for 2 or 3 alternating ones",
        )
    return None


def _axis_problems(
    document: Document, at: Pointer, joints: Sequence[Mapping[str, Any]]
) -> Iterator[Problem]:
    """Yield an error for each joint of a planar actuator whose axis is not that of the first."""
    axes = [joint.get("axis", [1, 0, 0]) for joint in joints]
    for index, axis in enumerate(axes):
        if axis != axes[0]:
            yield Problem(
                document.span((*at, index, "axis")),
                f"planar_flag 2 needs the same axis for all joints, found {axis} after {axes[0]}",
                "use planar_flag 0 for several axes",
            )


def _placement_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    link = data.get("link_definition")
    if (
        isinstance(link, Mapping)
        and is_sound((*at, "link_definition"))
        and data.get("joint_placement") == "gauss"
        and link["shape_type"] == "sphere"
    ):
        yield Problem(
            document.span((*at, "joint_placement")),
            "joint_placement gauss needs links of different lengths, and spheres have no length",
            "use a cylinder, a capsule or a box, or joint_placement: uniform",
        )


def _length_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    link = (*at, "link_definition")
    if not (isinstance(data.get("link_definition"), Mapping) and is_sound(link)):
        return
    if "actuator_length" not in data or not is_sound((*at, "actuator_length")):
        return
    height = link_from(data["link_definition"]).height
    length = data["n_segments"] * height
    if not math.isclose(length, data["actuator_length"], rel_tol=LENGTH_TOLERANCE):
        yield Problem(
            document.span((*at, "actuator_length")),
            f"actuator_length {data['actuator_length']:.9g} is not n_segments "
            f"{data['n_segments']} times the link's height {height:.9g}",
            f"leave actuator_length out, or set it to {length:.9g}",
        )


def _joint_problems(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    axis = data.get("axis")
    if axis is not None and geometry.norm(tuple(axis)) < 1e-12:
        yield Problem(
            document.span((*at, "axis")),
            f"axis {list(axis)} has no length",
            "give the direction of the axis, such as [1, 0, 0]",
        )
    limits = data.get("limits")
    if limits is None and data["joint_type"] == "revolute":
        yield Problem(
            document.span(at),
            "a revolute joint needs limits",
            "add limits: [lower, upper, effort, velocity], or use joint_type: continuous",
        )
    if limits is not None and limits[0] > limits[1]:
        yield Problem(
            document.span((*at, "limits")),
            f"lower limit {limits[0]} is above upper limit {limits[1]}",
            "limits are [lower, upper, effort, velocity]",
        )
    offset = data.get("neutral_axis_offset")
    if offset is not None and any(angle != 0 for angle in offset[3:]):
        yield Problem(
            document.span((*at, "neutral_axis_offset")),
            f"the angles of neutral_axis_offset must be 0, found {offset[3:]}",
            "choose the direction of the joint with axis",
        )


def _joint_count_problems(
    document: Document, at: Pointer, actuators: Sequence[Any], is_sound: IsSound
) -> Iterator[Problem]:
    count = 0
    for index, actuator in enumerate(actuators):
        if not isinstance(actuator, Mapping) or not is_sound((*at, index, "n_segments")):
            return
        count += _moving_joints(actuator)
    if count > MAXIMUM_JOINTS:
        yield Problem(
            document.span(at, key=True),
            f"{count} joints, but the engine ignores commands beyond {MAXIMUM_JOINTS} joints",
            "use fewer and longer segments; an error of 1 % needs about 5 joints per axis",
        )


def _moving_joints(actuator: Mapping[str, Any]) -> int:
    """Return the number of joints of an actuator that move; its joint definitions alternate."""
    segments = actuator.get("n_segments", 0)
    kinds = [
        joint.get("joint_type") if isinstance(joint, Mapping) else None
        for joint in _items(actuator.get("joint_definitions"))
    ]
    rounds, rest = divmod(segments, max(1, len(kinds)))
    fixed = rounds * kinds.count("fixed") + kinds[:rest].count("fixed")
    return int(segments - fixed)
