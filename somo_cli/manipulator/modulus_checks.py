"""Check where the stiffness of the joints of an actuator comes from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.elastic_link import joint_stiffness
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.manipulator.read import joint_axis, link_from
from somo_cli.problems import Pointer, Problem


def modulus_problems(
    document: Document, at: Pointer, actuator: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    """Yield an error for each joint of an actuator whose stiffness is not known."""
    link = actuator["link_definition"]
    joints = actuator.get("joint_definitions")
    if link.get("modulus") is None or not is_sound((*at, "link_definition")):
        return  # the schema then asks for a stiffness
    for index, joint in enumerate(joints if isinstance(joints, list) else ()):
        place = (*at, "joint_definitions", index)
        if not isinstance(joint, Mapping) or not is_sound(place) or not _needs(joint):
            continue
        try:
            joint_stiffness(link, link_from(link).solid, joint_axis(joint), 1.0)
        except ValueError as error:
            message = f"no stiffness follows from the modulus: {error}"
            hint = "give the joint a spring_stiffness [N·m/rad]"
            yield Problem(document.span(place), message, hint)


def _needs(joint: Mapping[str, Any]) -> bool:
    """Return whether a joint moves and has no stiffness of its own, but an axis."""
    axis = joint.get("axis")
    is_axis = axis is None or any(abs(one) > 0 for one in axis)
    return joint["joint_type"] != "fixed" and joint.get("spring_stiffness") is None and is_axis
