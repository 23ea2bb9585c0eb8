"""Read the numbers and poses of URDF elements, and report errors in them."""

from __future__ import annotations

import math

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import MAX_NUMBER, Problem
from somo_cli.scene.urdf_xml import XmlElement


def report(problems: list[Problem], element: XmlElement, message: str, hint: str = "") -> None:
    """Add an error at an element of the URDF to `problems`."""
    problems.append(Problem(element.span, message, hint))


def origin_of(problems: list[Problem], element: XmlElement) -> Pose:
    """Return the pose that the <origin> of an element gives [m, rad]; the identity without one."""
    origin = element.first_child_with_tag("origin")
    if origin is None:
        return Pose()
    position = numbers(problems, origin, "xyz", 3, "0 0 0")
    rpy = numbers(problems, origin, "rpy", 3, "0 0 0")
    return Pose.of(geometry.vector(position), geometry.vector(rpy))


def numbers(
    problems: list[Problem], element: XmlElement, name: str, count: int, default: str | None = None
) -> list[float]:
    """Return the numbers of an attribute; if they are wrong, report an error and return ones."""
    text = element.attributes.get(name, default)
    words = "one number" if count == 1 else f"{count} numbers"
    if text is None:
        report(problems, element, f"<{element.tag}> has no {name}", f"it has {words}")
        return [1.0] * count
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(math.isfinite(value) for value in values):
        report(problems, element, f"{name} of <{element.tag}> is '{text}'", f"it has {words}")
        return [1.0] * count
    if max(map(abs, values)) > MAX_NUMBER:
        hint = f"no number may be larger than {MAX_NUMBER:g}"
        report(problems, element, f"{name} of <{element.tag}> is '{text}', too large", hint)
        return [1.0] * count
    return values


def positive_numbers(
    problems: list[Problem], element: XmlElement, name: str, count: int = 1
) -> list[float]:
    """Return the numbers of an attribute; report an error if one of them is not positive."""
    values = numbers(problems, element, name, count)
    if min(values) <= 0:
        text = element.attributes[name]
        report(problems, element, f"{name} of <{element.tag}> is '{text}', not greater than 0")
    return values
