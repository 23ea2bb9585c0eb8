"""Write MJCF, MuJoCo's format, of a chain: in SI, with its springs, dampers, limits and motors."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from somo_cli.exchange.mjcf_actuators import add_motors
from somo_cli.exchange.mjcf_bodies import add_chain, add_locks
from somo_cli.exchange.xml_text import document_text, numbers
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.urdf import number

STANDARD_GRAVITY: Vector = (0.0, 0.0, -9.81)  # m/s²


def render_chain(
    chain: Chain,
    time_step: float,
    gravity: Vector = STANDARD_GRAVITY,
    tip_frame: str = "tip",
    is_fixed: bool = True,
) -> str:
    """Return the MJCF of a chain in its own units, its base fixed at the origin or free.

    `time_step` [s] is that of MuJoCo, whose springs are explicit in position and so bound it.
    Its geoms touch those of others that keep MuJoCo's defaults, but not each other.
    """
    root, world, assets = new_model(chain.name, time_step, gravity, ("1", "0"))
    bodies = add_chain(world, assets, chain, tip_frame=tip_frame, time_step=time_step)
    if not is_fixed:
        bodies.bodies[0].insert(0, ET.Element("freejoint", name="base_joint"))
    add_locks(root, chain, time_step)
    add_motors(root, chain)
    return finished(root, f"{chain.name}: SI units; the control of a motor is N m in every joint")


def new_model(
    name: str, time_step: float, gravity: Vector, collides: tuple[str, str]
) -> tuple[ET.Element, ET.Element, ET.Element]:
    """Return a model without bodies: its root, its world and its assets.

    `collides` has contype and conaffinity of all geoms.
    """
    root = ET.Element("mujoco", model=name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="false")
    ET.SubElement(
        root,
        "option",
        timestep=number(time_step),
        gravity=numbers(gravity),
        integrator="implicitfast",
        cone="elliptic",
    )
    default = ET.SubElement(root, "default")
    contype, conaffinity = collides
    ET.SubElement(default, "geom", contype=contype, conaffinity=conaffinity)
    ET.SubElement(default, "site", size="0.001", group="4")
    assets = ET.SubElement(root, "asset")
    sky = {"type": "skybox", "builtin": "gradient", "width": "64", "height": "64"}
    ET.SubElement(assets, "texture", sky, name="sky", rgb1="0.9 0.95 1", rgb2="0.6 0.7 0.8")
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(world, "light", pos="0 0 3", dir="0 0 -1", type="directional")
    return root, world, assets


def finished(root: ET.Element, comment: str) -> str:
    """Return the text of a model, without sections that are empty."""
    for section in list(root):
        if len(section) == 0 and not section.attrib:
            root.remove(section)
    return document_text(root, comment)
