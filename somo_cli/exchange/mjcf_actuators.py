"""Write a motor for each axis of an actuator and for each load of a scene."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from somo_cli.exchange.xml_text import numbers
from somo_cli.manipulator.chain import Chain
from somo_cli.scene.model import ExternalLoad
from somo_cli.scene.quantities import channel_names, channels

_WORLD_SITE = "world"


def add_motors(root: ET.Element, chain: Chain, prefix: str = "") -> None:
    """Add a motor for each axis of each actuator: its control is the torque in every joint [N·m].

    Each motor pulls on a tendon whose length is the sum of the angles of its joints, so that its
    force is a torque in each of them.
    """
    tendons, motors = _section(root, "tendon"), _section(root, "actuator")
    for (actuator, axis), name in zip(channels(chain), channel_names(chain), strict=True):
        tendon = ET.SubElement(tendons, "fixed", name=prefix + name)
        for joint in chain.joints:
            if (joint.actuator, joint.channel) == (actuator, axis):
                ET.SubElement(tendon, "joint", joint=prefix + joint.name, coef="1")
        ET.SubElement(motors, "motor", name=prefix + name, tendon=prefix + name)


def add_loads(
    root: ET.Element,
    world: ET.Element,
    bodies: Sequence[ET.Element],
    loads: Sequence[ExternalLoad],
    prefix: str,
) -> None:
    """Add a motor for each load: its control is the factor of the load [-].

    A load in the world's axes acts at a site relative to one of the world.
    """
    for number, load in enumerate(loads):
        name = f"{prefix}load_{number}"
        ET.SubElement(bodies[load.link], "site", name=name, pos=numbers(load.point))
        gear = numbers((*load.force, *load.moment))
        motor = ET.SubElement(_section(root, "actuator"), "motor", name=name, site=name, gear=gear)
        if load.frame == "world":
            if world.find(f"site[@name='{_WORLD_SITE}']") is None:
                ET.SubElement(world, "site", name=_WORLD_SITE)
            motor.set("refsite", _WORLD_SITE)


def _section(root: ET.Element, tag: str) -> ET.Element:
    found = root.find(tag)
    return ET.SubElement(root, tag) if found is None else found
