"""Write a chain of links as bodies of MJCF, with the springs, dampers and limits of its joints."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass

from somo_cli.exchange.mjcf_geoms import add_geoms
from somo_cli.exchange.xml_text import numbers, pose_attributes
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain, Joint, Link
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import Inertial
from somo_cli.manipulator.urdf import number

_HARD = "0.999 0.999 0.001 0.5 2"
"""Impedance of limits: by default a stiff spring pushes a light link far beyond one."""


@dataclass(frozen=True, slots=True)
class ChainBodies:
    """The bodies of a chain, by number of their link, and the geoms of each that can touch."""

    bodies: tuple[ET.Element, ...]
    geoms: tuple[tuple[str, ...], ...]


def add_chain(
    parent: ET.Element,
    assets: ET.Element,
    chain: Chain,
    prefix: str = "",
    pose: Pose | None = None,
    tip_frame: str = "tip",
    time_step: float = 1e-3,
) -> ChainBodies:
    """Add the bodies of a chain to a body or the world; return them.

    Names of bodies and joints are those of links and joints after `prefix`. `pose` is that of the
    base frame in `parent`. Each end of a backbone has a site, `tip_frame` after the name of its
    limb. Joint limits are as hard as the time step [s] of the model allows.
    """
    pose = pose or Pose()
    first = ET.SubElement(parent, "body", name=prefix + chain.links[0].name)
    first.attrib.update(pose_attributes(pose.position, pose.rotation))
    add_inertial(first, chain.links[0].inertial)
    bodies = [first]
    geoms = [add_geoms(first, assets, chain.links[0], prefix + chain.links[0].name)]
    for joint, link in zip(chain.joints, chain.links[1:], strict=True):
        body = _add_link(bodies[joint.parent], joint, link, prefix, time_step)
        bodies.append(body)
        geoms.append(add_geoms(body, assets, link, prefix + link.name))
    for limb in chain.backbones:
        attributes = {"name": prefix + limb.prefix + tip_frame} | pose_attributes(
            limb.tip, geometry.IDENTITY
        )
        ET.SubElement(bodies[limb.last_link], "site", attributes)
    return ChainBodies(tuple(bodies), tuple(geoms))


def tip_name(prefix: str, limb_prefix: str) -> str:
    """Return the name of the site at the tip of a limb."""
    return f"{prefix}{limb_prefix}tip"


def add_locks(root: ET.Element, chain: Chain, time_step: float, prefix: str = "") -> None:
    """Hold the joints whose limits are equal: MuJoCo takes no such limits.

    The constraint is as hard as the time step [s] allows.
    """
    locked = [joint for joint in chain.joints if joint.lower == joint.upper]
    if not locked:
        return
    equality = root.find("equality")
    equality = ET.SubElement(root, "equality") if equality is None else equality
    for joint in locked:
        ET.SubElement(
            equality,
            "joint",
            name=f"{prefix}{joint.name}.lock",
            joint1=prefix + joint.name,
            polycoef=numbers((joint.lower, 0, 0, 0, 0)),
            solref=numbers((2 * time_step, 1.0)),
            solimp=_HARD,
        )


def _add_link(
    parent: ET.Element, joint: Joint, link: Link, prefix: str, time_step: float
) -> ET.Element:
    body = ET.SubElement(parent, "body", name=prefix + link.name)
    rotation = geometry.rotation_from_rpy(joint.rpy)
    if joint.rpy == geometry.ZERO:
        rotation = geometry.IDENTITY
    body.attrib.update(pose_attributes(joint.origin, rotation))
    add_inertial(body, link.inertial)
    element = ET.SubElement(body, "joint", name=prefix + joint.name, axis=numbers(joint.axis))
    if joint.lower < joint.upper:
        element.set("limited", "true")
        element.set("range", numbers((joint.lower, joint.upper)))
        element.set("solreflimit", numbers((2 * time_step, 1.0)))
        element.set("solimplimit", _HARD)
    values = (
        ("stiffness", joint.stiffness),
        ("springref", joint.neutral_position),
        ("damping", joint.damping),
        ("frictionloss", joint.friction),
    )
    for name, value in values:
        if value:
            element.set(name, number(value))
    return body


def add_inertial(body: ET.Element, inertial: Inertial) -> None:
    """Add mass, centre of mass and inertia about it, along the axes of the body."""
    xx, xy, xz, yy, yz, zz = inertial.inertia
    attributes = {"pos": numbers(inertial.centre), "mass": number(inertial.mass)}
    if xy or xz or yz:
        attributes["fullinertia"] = numbers((xx, yy, zz, xy, xz, yz))
    else:
        attributes["diaginertia"] = numbers((xx, yy, zz))
    ET.SubElement(body, "inertial", attributes)
