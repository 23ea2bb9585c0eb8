"""Read attributes of MJCF: defaults of classes, angles in the file's unit, and orientations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import Problem
from somo_cli.scene.urdf_values import numbers, report
from somo_cli.scene.urdf_xml import XmlElement

_MAIN = "main"


class MjcfValues:
    """The values of the elements of one model, with the defaults of their classes."""

    def __init__(self, problems: list[Problem], root: XmlElement) -> None:
        self.problems = problems
        compiler = root.first_child_with_tag("compiler")
        own = compiler.attributes if compiler else {}
        self._unit = 1.0 if own.get("angle") == "radian" else math.pi / 180  # rad
        self._sequence = own.get("eulerseq", "xyz")
        self._has_auto_limits = own.get("autolimits", "true") != "false"
        self._defaults: dict[str, dict[str, Mapping[str, str]]] = {_MAIN: {}}
        for element in root.children_with_tag("default"):
            self._read_class(element, {}, element.attributes.get("class", _MAIN))

    def _read_class(
        self, element: XmlElement, inherited: Mapping[str, Mapping[str, str]], name: str
    ) -> None:
        own = dict(inherited)
        for child in element.children:
            if child.tag != "default":
                own[child.tag] = {**own.get(child.tag, {}), **child.attributes}
        self._defaults[name] = {**self._defaults.get(name, {}), **own}
        for child in element.children_with_tag("default"):
            self._read_class(child, own, child.attributes.get("class", _MAIN))

    def full(self, element: XmlElement, child_class: str) -> XmlElement:
        """Return an element with the defaults of its class, else those of its body's class."""
        name = element.attributes.get("class", child_class or _MAIN)
        if name not in self._defaults:
            report(self.problems, element, f"there is no class '{name}'")
        defaults = self._defaults.get(name, {}).get(element.tag, {})
        return replace(element, attributes={**defaults, **element.attributes})

    def number(self, element: XmlElement, name: str, default: float = 0.0) -> float:
        """Return the number of an attribute."""
        return numbers(self.problems, element, name, 1, repr(default))[0]

    def angle(self, element: XmlElement, name: str) -> float:
        """Return an angle [rad], 0 without the attribute."""
        return self.number(element, name) * self._unit

    def range_of(self, joint: XmlElement) -> tuple[float, float]:
        """Return the limits of a joint [rad], lower > upper without."""
        limited = joint.attributes.get("limited", "auto")
        has_range = "range" in joint.attributes
        if limited == "true" or (limited == "auto" and self._has_auto_limits and has_range):
            lower, upper = numbers(self.problems, joint, "range", 2, "0 0")
            return lower * self._unit, upper * self._unit
        return 0.0, -1.0

    def pose(self, element: XmlElement) -> Pose:
        """Return the pose of an element in its parent's frame."""
        position = numbers(self.problems, element, "pos", 3, "0 0 0")
        return Pose(geometry.vector(position), self._rotation(element))

    def _rotation(self, element: XmlElement) -> Matrix:
        given = element.attributes
        if "quat" in given:
            w, x, y, z = numbers(self.problems, element, "quat", 4)
            length = math.hypot(w, x, y, z)
            if length == 0:
                report(self.problems, element, "the quaternion has no length")
                return geometry.IDENTITY
            return geometry.rotation_from_quaternion(
                (x / length, y / length, z / length, w / length)
            )
        if "euler" in given:
            return self._from_euler(numbers(self.problems, element, "euler", 3))
        if "axisangle" in given:
            *axis, angle = numbers(self.problems, element, "axisangle", 4)
            return geometry.rotation_about(geometry.unit(geometry.vector(axis)), angle * self._unit)
        for name in ("xyaxes", "zaxis"):
            if name in given:
                report(self.problems, element, f"{name} is not read", "give quat or euler")
        return geometry.IDENTITY

    def _from_euler(self, angles: list[float]) -> Matrix:
        """Return the rotation of Euler angles, about moving axes (lower case) or fixed ones."""
        turned = geometry.IDENTITY
        for letter, angle in zip(self._sequence, angles, strict=True):
            axis = geometry.vector(float(letter.lower() == one) for one in "xyz")
            turn = geometry.rotation_about(axis, angle * self._unit)
            is_moving = letter.islower()
            turned = geometry.multiply(*((turned, turn) if is_moving else (turn, turned)))
        return turned
