"""An actuator that gets thinner: links and joints at a place, from those at its start.

Both widths change linearly along the actuator, by a factor w at a place. The area of the section is
then w² times that at the start, and its second moments and torsion constant w⁴ times. So a link has
w² of the mass, and a joint w⁴ of stiffness and damping, those of one material.
"""

from __future__ import annotations

from dataclasses import replace

from somo_cli.manipulator.definition import (
    ActuatorDefinition,
    JointDefinition,
    LinkDefinition,
)
from somo_cli.manipulator.solids import Sphere


def width_at(actuator: ActuatorDefinition, place: float) -> float:
    """Return the width at a place, from 0 at the start to 1 at the end, over that at the start."""
    return 1.0 + (actuator.taper - 1.0) * place


def link_at(actuator: ActuatorDefinition, place: float) -> LinkDefinition:
    """Return the link whose middle is at a place, at its full length."""
    link = actuator.link
    if actuator.taper == 1.0 or isinstance(link.solid, Sphere):
        return link
    width = width_at(actuator, place)
    return replace(link, solid=link.solid.widened(width), mass=link.mass * width**2)


def joint_at(actuator: ActuatorDefinition, joint: JointDefinition, place: float) -> JointDefinition:
    """Return a joint at a place, from one at the start."""
    if actuator.taper == 1.0:
        return joint
    share = width_at(actuator, place) ** 4
    return replace(joint, stiffness=joint.stiffness * share, damping=joint.damping * share)
