"""Read the numbers of elements whose text, not an attribute, is the value, as in SDF."""

from __future__ import annotations

from dataclasses import replace

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import Problem
from somo_cli.scene import urdf_values
from somo_cli.scene.urdf_xml import XmlElement


def text_numbers(
    problems: list[Problem], owner: XmlElement, tag: str, count: int, default: str | None = None
) -> list[float]:
    """Return the numbers in the child with a tag; report an error if they are wrong."""
    child = owner.first_child_with_tag(tag)
    if child is None:
        return urdf_values.numbers(problems, owner, tag, count, default)
    held = replace(child, attributes={**child.attributes, tag: child.text})
    return urdf_values.numbers(problems, held, tag, count)


def text_number(
    problems: list[Problem], owner: XmlElement | None, tag: str, default: float
) -> float:
    """Return the number in the child with a tag, or a default."""
    if owner is None or owner.first_child_with_tag(tag) is None:
        return default
    return text_numbers(problems, owner, tag, 1)[0]


def text_pose(problems: list[Problem], owner: XmlElement) -> Pose:
    """Return the pose in <pose>: position, roll, pitch and yaw; the identity without one."""
    values = text_numbers(problems, owner, "pose", 6, "0 0 0 0 0 0")
    return Pose.of(geometry.vector(values[:3]), geometry.vector(values[3:]))
