"""Write SDF, Gazebo's format, of a chain, with springs, dampers, dry friction and limits.

Angles of springs are in rad. A reader that ignores `spring_stiffness` ignores the springs: Gazebo
with some engines does, Drake does not.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

from somo_cli.exchange.xml_text import document_text, numbers
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain, Joint, Link, Shape
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.solids import Box, Cylinder, Sphere
from somo_cli.manipulator.urdf import number

_VERSION = "1.9"
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def render_chain(chain: Chain, tip_frame: str | None = None, is_fixed: bool = True) -> str:
    """Return the SDF of a chain in the chain's own units, its base fixed to the world or free.

    With `tip_frame` the tip of each limb has a frame of that name after the limb's.
    """
    root = ET.Element("sdf", version=_VERSION)
    model = ET.SubElement(root, "model", name=chain.name)
    _add_link(model, chain.links[0], None)
    if is_fixed:
        hold = ET.SubElement(model, "joint", name="world_joint", type="fixed")
        _add_text(hold, "parent", "world")
        _add_text(hold, "child", chain.links[0].name)
    for joint, link in zip(chain.joints, chain.links[1:], strict=True):
        _add_link(model, link, joint.name)
        _add_joint(model, joint, chain.links[joint.parent].name, link.name)
    for limb in chain.backbones if tip_frame is not None else ():
        name, last = f"{limb.prefix}{tip_frame}", chain.links[limb.last_link].name
        frame = ET.SubElement(model, "frame", name=name, attached_to=last)
        _add_pose(frame, limb.tip, geometry.ZERO)
    return document_text(root, f"{chain.name}: SI units; springs are in the dynamics of joints")


def _add_link(model: ET.Element, link: Link, joint: str | None) -> None:
    """Add a link, whose frame is that of the joint that moves it; the root's is the model's."""
    element = ET.SubElement(model, "link", name=link.name)
    if joint is not None:
        _add_pose(element, geometry.ZERO, geometry.ZERO, joint)
    inertial = ET.SubElement(element, "inertial")
    _add_pose(inertial, link.inertial.centre, geometry.ZERO)
    _add_text(inertial, "mass", number(link.inertial.mass))
    inertia = ET.SubElement(inertial, "inertia")
    for name, value in zip(_MOMENTS, link.inertial.inertia, strict=True):
        _add_text(inertia, name, number(value))
    for index, shape in enumerate(link.shapes):
        visual = ET.SubElement(element, "visual", name=f"visual_{index}")
        _add_shape(visual, shape, shape.visual_factor)
        material = ET.SubElement(visual, "material")
        for kind in ("ambient", "diffuse"):
            _add_text(material, kind, numbers(shape.material.rgba))
        collision = ET.SubElement(element, "collision", name=f"collision_{index}")
        _add_shape(collision, shape, 1.0)


def _add_shape(parent: ET.Element, shape: Shape, factor: float) -> None:
    _add_pose(parent, shape.position, shape.rpy)
    geometry_element = ET.SubElement(parent, "geometry")
    solid = shape.solid
    if isinstance(solid, Box):
        box = ET.SubElement(geometry_element, "box")
        _add_text(box, "size", numbers(edge * factor for edge in solid.size))
        return
    assert isinstance(solid, Cylinder | Sphere), "links have no other shapes"
    kind = "cylinder" if isinstance(solid, Cylinder) else "sphere"
    round_shape = ET.SubElement(geometry_element, kind)
    _add_text(round_shape, "radius", number(solid.radius * factor))
    if isinstance(solid, Cylinder):
        _add_text(round_shape, "length", number(solid.length * factor))


def _add_joint(model: ET.Element, joint: Joint, parent: str, child: str) -> None:
    kind = "revolute" if joint.is_limited else "continuous"
    element = ET.SubElement(model, "joint", name=joint.name, type=kind)
    _add_pose(element, joint.origin, joint.rpy, parent)
    _add_text(element, "parent", parent)
    _add_text(element, "child", child)
    axis = ET.SubElement(element, "axis")
    _add_text(axis, "xyz", numbers(joint.axis))
    _add_limits(axis, joint)
    dynamics = ET.SubElement(axis, "dynamics")
    _add_text(dynamics, "damping", number(joint.damping))
    _add_text(dynamics, "friction", number(joint.friction))
    _add_text(dynamics, "spring_reference", number(joint.neutral_position))
    _add_text(dynamics, "spring_stiffness", number(joint.stiffness))


def _add_limits(axis: ET.Element, joint: Joint) -> None:
    """Add the limits that a joint has; an effort or a velocity of zero means none."""
    limits = {
        name: value
        for name, value in (("effort", joint.effort), ("velocity", joint.velocity))
        if value > 0
    }
    if joint.is_limited:
        limits = {"lower": joint.lower, "upper": joint.upper, **limits}
    if limits:
        element = ET.SubElement(axis, "limit")
        for name, value in limits.items():
            _add_text(element, name, number(value))


def _add_pose(
    parent: ET.Element, position: Vector, rpy: Vector, relative_to: str | None = None
) -> None:
    """Add a pose, of a frame of another element or by default of the one that holds it."""
    if relative_to is None and position == rpy == geometry.ZERO:
        return
    element = ET.SubElement(parent, "pose")
    if relative_to is not None:
        element.set("relative_to", relative_to)
    element.text = numbers((*position, *rpy))


def _add_text(parent: ET.Element, tag: str, text: str) -> None:
    ET.SubElement(parent, tag).text = text
