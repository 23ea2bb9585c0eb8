"""Write the URDF text of a chain; the same chain gives the same bytes.

Damping and dry friction are in `<dynamics>`. URDF has no element for springs, so they are in
extension tags of Gazebo: `springStiffness` and `springReference`, in camel case because libsdformat
12.3 ignores the other spelling. Lines are short because PyBullet 3.2.7 silently cuts them at 8191
characters.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from somo_cli.manipulator.chain import Chain, Joint, Limb, Link, Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Sphere


@dataclass(frozen=True, slots=True)
class _Contents:
    """Which optional elements a URDF has: visuals with their materials, collisions, dynamics.

    With `has_all_limits` joints without limits have effort and velocity, which URDF does not ask.
    """

    has_visuals: bool = True
    has_collisions: bool = True
    has_dynamics: bool = True
    has_all_limits: bool = False


_HEADER = '<?xml version="1.0" encoding="utf-8"?>\n'
_NEVER_REACHED = 1e6
"""Effort and velocity of a joint without limits: readers that want both take 0 for no motion."""
_SCALE_NOTE = "<!-- World scale "


def is_ours(path: Path) -> bool:
    """Whether a file begins as the URDFs do that `render` returns. Raises OSError."""
    starts = tuple(f"{_HEADER}{first}".encode() for first in ('<robot name="', _SCALE_NOTE))
    with path.open("rb") as stream:
        return stream.read(max(map(len, starts))).startswith(starts)


def is_scaled(text: str) -> bool:
    """Return whether a URDF begins with the comment of `scale_note`: it is not in SI."""
    return text.startswith(f"{_HEADER}{_SCALE_NOTE}")


def scale_note(scale: Scale) -> str:
    """Return the comment of a URDF in the units of a scale, a line; empty in SI."""
    if scale == Scale():
        return ""
    of_length, of_mass = number(scale.length), number(scale.mass)
    return (
        f"{_SCALE_NOTE}{of_length}, for PyBullet: lengths are {of_length} times and masses "
        f"{of_mass} times their SI values. Other tools want scale 1. -->\n"
    )


def render(
    chain: Chain, tip_frame: str | None = None, note: str = "", has_all_limits: bool = False
) -> str:
    """Return the URDF of a chain, in the chain's own units.

    With `tip_frame` a massless link of that name is fixed to the tip, for tools that need a frame
    there. It does not change the dynamics, and `somo run` does not load it. In an assembly each
    limb has one, whose name starts with that of the limb. `note` is a comment before the robot.
    With `has_all_limits` a continuous joint too has effort and velocity, so large that they never
    matter unless the definition has them.
    """
    robot = _robot(chain, _Contents(has_all_limits=has_all_limits))
    if tip_frame is not None:
        for limb in chain.backbones:
            _add_tip_frame(robot, chain, limb, limb.prefix + tip_frame)
    for joint in chain.joints:
        _add_spring(robot, joint)
    return _text(robot, note)


def render_for_engine(
    chain: Chain, with_collisions: bool, with_visuals: bool = False, with_limits: bool = True
) -> str:
    """Return the URDF for the engine of a run, in the chain's own units.

    It has no springs, dampers or dry friction: the integrator applies those, and the engine would
    add its own explicit damper. It has collision shapes only with `with_collisions`, visual shapes
    only with both `with_collisions` and `with_visuals`, and joint limits only with `with_limits`.
    """
    chain = chain if with_limits else chain.without_limits()
    visuals = with_collisions and with_visuals
    return _text(_robot(chain, _Contents(visuals, with_collisions, has_dynamics=False)))


def number(value: float) -> str:
    """Return the shortest decimal text that reads back as exactly this float."""
    text = repr(float(value))
    if text.endswith(".0"):
        text = text[:-2]
    return "0" if text == "-0" else text


def _robot(chain: Chain, contents: _Contents) -> ET.Element:
    """Return the tree of materials, links and joints, every link after the joint that moves it."""
    robot = ET.Element("robot", name=chain.name)
    names = _material_names(chain) if contents.has_visuals else {}
    for material, name in names.items():
        element = ET.SubElement(robot, "material", name=name)
        ET.SubElement(element, "color", rgba=_numbers(material.rgba))
    _add_link(robot, chain.links[0], names, contents)
    for index, joint in enumerate(chain.joints):
        parent, child = chain.links[joint.parent], chain.links[index + 1]
        _add_joint(robot, joint, parent.name, child.name, contents)
        _add_link(robot, child, names, contents)
    return robot


def _text(robot: ET.Element, note: str = "") -> str:
    ET.indent(robot)
    return _HEADER + note + ET.tostring(robot, encoding="unicode") + "\n"


def _numbers(values: Iterable[float]) -> str:
    return " ".join(number(value) for value in values)


def _material_names(chain: Chain) -> dict[Material, str]:
    """Return a name for each material; if two have the same name, the second gets a number."""
    names: dict[Material, str] = {}
    taken: set[str] = set()
    for link in chain.links:
        for shape in link.shapes:
            if shape.material in names:
                continue
            name, count = shape.material.name, 1
            while name in taken:
                count += 1
                name = f"{shape.material.name}_{count}"
            taken.add(name)
            names[shape.material] = name
    return names


def _add_link(
    robot: ET.Element, link: Link, names: dict[Material, str], contents: _Contents
) -> None:
    element = ET.SubElement(robot, "link", name=link.name)
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=_numbers(link.inertial.centre), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=number(link.inertial.mass))
    names_of_six = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    six = zip(names_of_six, map(number, link.inertial.inertia), strict=True)
    ET.SubElement(inertial, "inertia", dict(six))
    for shape in link.shapes if contents.has_visuals else ():
        visual = ET.SubElement(element, "visual")
        _add_geometry(visual, shape, shape.visual_factor)
        ET.SubElement(visual, "material", name=names[shape.material])
    for shape in link.shapes if contents.has_collisions else ():
        _add_geometry(ET.SubElement(element, "collision"), shape, 1.0)


def _add_geometry(parent: ET.Element, shape: Shape, factor: float) -> None:
    ET.SubElement(parent, "origin", xyz=_numbers(shape.position), rpy=_numbers(shape.rpy))
    element = ET.SubElement(parent, "geometry")
    tag, attributes = _geometry(shape.solid, factor)
    ET.SubElement(element, tag, attributes)


def _geometry(solid: AnySolid, factor: float) -> tuple[str, dict[str, str]]:
    if isinstance(solid, Box):
        return "box", {"size": _numbers(edge * factor for edge in solid.size)}
    if isinstance(solid, Cylinder):
        length, radius = number(solid.length * factor), number(solid.radius * factor)
        return "cylinder", {"length": length, "radius": radius}
    assert isinstance(solid, Sphere), "other solids are not loaded from a URDF"
    return "sphere", {"radius": number(solid.radius * factor)}


def _add_joint(
    robot: ET.Element, joint: Joint, parent: str, child: str, contents: _Contents
) -> None:
    kind = "revolute" if joint.is_limited else "continuous"
    element = ET.SubElement(robot, "joint", name=joint.name, type=kind)
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    ET.SubElement(element, "origin", xyz=_numbers(joint.origin), rpy=_numbers(joint.rpy))
    ET.SubElement(element, "axis", xyz=_numbers(joint.axis))
    if joint.is_limited or contents.has_all_limits:
        limit = ET.SubElement(element, "limit")
        if joint.is_limited:
            limit.set("lower", number(joint.lower))
            limit.set("upper", number(joint.upper))
        free = 0.0 if joint.is_limited else _NEVER_REACHED
        limit.set("effort", number(joint.effort or free))
        limit.set("velocity", number(joint.velocity or free))
    if contents.has_dynamics:
        dynamics = {"damping": number(joint.damping), "friction": number(joint.friction)}
        ET.SubElement(element, "dynamics", dynamics)


def _add_spring(robot: ET.Element, joint: Joint) -> None:
    element = ET.SubElement(robot, "gazebo", reference=joint.name)
    ET.SubElement(element, "springStiffness").text = number(joint.stiffness)
    ET.SubElement(element, "springReference").text = number(joint.neutral_position)
    ET.SubElement(element, "implicitSpringDamper").text = "true"


def _add_tip_frame(robot: ET.Element, chain: Chain, limb: Limb, name: str) -> None:
    ET.SubElement(robot, "link", name=name)
    joint = ET.SubElement(robot, "joint", name=f"{name}_joint", type="fixed")
    ET.SubElement(joint, "parent", link=chain.links[limb.last_link].name)
    ET.SubElement(joint, "child", link=name)
    ET.SubElement(joint, "origin", xyz=_numbers(limb.tip), rpy="0 0 0")
