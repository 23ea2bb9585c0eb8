"""Chain to URDF text, the same bytes every time.

The file is complete by itself: damping and dry friction are in `<dynamics>`, the springs, for
which URDF has no element, in the extension tags that Gazebo reads (`springStiffness` and
`springReference`, camelCase: libsdformat 12.3 ignores the other spelling). Lines are short,
because PyBullet 3.2.7 cuts lines at 8191 characters without a word.
"""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET
from collections.abc import Iterable

from somo_cli.manipulator.chain import Chain, Joint, Limb, Link, Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Sphere

_HEADER = '<?xml version="1.0" encoding="utf-8"?>\n'


def render(chain: Chain, tip_frame: str | None = None) -> str:
    """Return the URDF of a chain, in the chain's own units.

    With `tip_frame` a massless link of that name is fixed to the tip, for tools that want a
    named frame there; it has no effect on the dynamics, and `somo run` never loads it. In an
    assembly every limb has one, its name after the limb's.
    """
    robot = ET.Element("robot", name=chain.name)
    names = _material_names(chain)
    for material, name in names.items():
        element = ET.SubElement(robot, "material", name=name)
        ET.SubElement(element, "color", rgba=_numbers(material.rgba))
    _add_link(robot, chain.links[0], names)
    for index, joint in enumerate(chain.joints):
        _add_joint(robot, joint, chain.links[joint.parent].name, chain.links[index + 1].name)
        _add_link(robot, chain.links[index + 1], names)
    if tip_frame is not None:
        for limb in chain.backbones:
            _add_tip_frame(robot, chain, limb, limb.prefix + tip_frame)
    for joint in chain.joints:
        _add_spring(robot, joint)
    return _text(robot)


def render_for_engine(
    chain: Chain, with_collisions: bool, with_visuals: bool = False, with_limits: bool = True
) -> str:
    """Return the URDF for a headless engine whose springs, dampers and friction are ours.

    It has visuals and collision shapes only if asked for; visuals go with collision shapes.
    """
    if not with_limits:
        chain = chain.without_limits()
    bare = tuple(
        dataclasses.replace(link, shapes=link.shapes if with_collisions else ())
        for link in chain.links
    )
    robot = ET.fromstring(render(dataclasses.replace(chain, links=bare)))
    for link in robot.findall("link"):
        for visual in [] if with_visuals else link.findall("visual"):
            link.remove(visual)
    for element in (*robot.findall("gazebo"), *([] if with_visuals else robot.findall("material"))):
        robot.remove(element)
    for joint in robot.findall("joint"):
        # dampers and friction are ours; the engine would add its own explicit damper
        for dynamics in joint.findall("dynamics"):
            joint.remove(dynamics)
    return _text(robot)


def number(value: float) -> str:
    """Return the shortest decimal that reads back as exactly this float."""
    text = repr(float(value))
    if text.endswith(".0"):
        text = text[:-2]
    return "0" if text == "-0" else text


def _text(robot: ET.Element) -> str:
    ET.indent(robot)
    return _HEADER + ET.tostring(robot, encoding="unicode") + "\n"


def _numbers(values: Iterable[float]) -> str:
    return " ".join(number(value) for value in values)


def _material_names(chain: Chain) -> dict[Material, str]:
    """Give every colour one name; a name that the file uses for two colours gets a number."""
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


def _add_link(robot: ET.Element, link: Link, names: dict[Material, str]) -> None:
    element = ET.SubElement(robot, "link", name=link.name)
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=_numbers(link.inertial.centre), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=number(link.inertial.mass))
    names_of_six = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    six = zip(names_of_six, map(number, link.inertial.inertia), strict=True)
    ET.SubElement(inertial, "inertia", dict(six))
    for shape in link.shapes:
        visual = ET.SubElement(element, "visual")
        _add_geometry(visual, shape, shape.visual_factor)
        ET.SubElement(visual, "material", name=names[shape.material])
    for shape in link.shapes:
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
    assert isinstance(solid, Sphere), "the engine takes all other objects without a URDF"
    return "sphere", {"radius": number(solid.radius * factor)}


def _add_joint(robot: ET.Element, joint: Joint, parent: str, child: str) -> None:
    kind = "revolute" if joint.is_limited else "continuous"
    element = ET.SubElement(robot, "joint", name=joint.name, type=kind)
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    ET.SubElement(element, "origin", xyz=_numbers(joint.origin), rpy=_numbers(joint.rpy))
    ET.SubElement(element, "axis", xyz=_numbers(joint.axis))
    if joint.is_limited:
        limit = ET.SubElement(element, "limit")
        limit.set("lower", number(joint.lower))
        limit.set("upper", number(joint.upper))
        limit.set("effort", number(joint.effort))
        limit.set("velocity", number(joint.velocity))
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
