"""Build the chain of one manipulator from its definition.

Parts that a fixed joint would connect are lumped into one link here: PyBullet 3.2.7 loses their
centres of mass when it merges links itself (URDF_MERGE_FIXED_LINKS).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Chain, Joint, Link, Shape
from somo_cli.manipulator.definition import (
    ActuatorDefinition,
    Definition,
    JointDefinition,
    LinkDefinition,
)
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.joint_placement import scaled_to_share
from somo_cli.manipulator.solids import Box, Cylinder, Inertial, Solid, Sphere
from somo_cli.manipulator.taper import joint_at, link_at


@dataclass(slots=True)
class _LinkBuilder:
    """Collects the parts of a link; `origin` is in the root's frame, with all joints at zero."""

    name: str
    origin: Vector
    inertials: list[Inertial] = field(default_factory=list)
    shapes: list[Shape] = field(default_factory=list)

    def add(self, part: LinkDefinition, solid: Solid, inertial: Inertial, start: float) -> None:
        """Add a part that starts at height `start` on the backbone."""
        at = geometry.subtract((0.0, 0.0, start + solid.height / 2), self.origin)
        at = geometry.add(at, part.offset)
        rotation = geometry.rotation_from_rpy(part.offset_rpy)
        self.inertials.append(solids.placed(inertial, at, rotation))
        self.shapes.append(Shape(solid, at, part.offset_rpy, part.material, part.visual_factor))

    def link(self) -> Link:
        """Return the link with the parts so far."""
        return Link(self.name, solids.lumped(tuple(self.inertials)), tuple(self.shapes))


def build_chain(definition: Definition) -> Chain:
    """Return the chain of a definition without limbs and without errors."""
    assert not definition.limbs
    bodies = [_LinkBuilder("base", geometry.ZERO)]
    joints: list[Joint] = []
    end = 0.0
    if definition.base is not None:
        end = _add_rounded_end(bodies[0], definition.base, end, at_base=True)
        if not definition.actuators:  # the body of an assembly: both ends are free
            _add_end_cap(bodies[0], definition.base, bodies[0].shapes[0].position, at_base=False)
    for index, actuator in enumerate(definition.actuators):
        end = _add_actuator(bodies, joints, actuator, index, end)
    for tip in definition.tips:
        _add_rounded_end(bodies[-1], tip, end, at_base=False)
    return Chain(
        definition.name,
        tuple(body.link() for body in bodies),
        tuple(joints),
        geometry.subtract((0.0, 0.0, end), bodies[-1].origin),
        end,
    )


def _add_actuator(
    bodies: list[_LinkBuilder],
    joints: list[Joint],
    actuator: ActuatorDefinition,
    index: int,
    start: float,
) -> float:
    end, done = start, 0.0
    digits = max(2, len(str(actuator.n_segments)))
    for segment, fraction in enumerate(actuator.fractions):
        link = link_at(actuator, (done + fraction / 2) / actuator.n_segments)
        if segment > 0:
            joint = scaled_to_share(actuator.joints[segment - 1], actuator.shares[segment - 1])
            joint = joint_at(actuator, joint, done / actuator.n_segments)
            hinge = (joint.offset[0], joint.offset[1], joint.offset[2] + end)
            bodies[-1].shapes.extend(_gap_filler(link, joint, hinge, bodies[-1].origin))
            if joint.joint_type != "fixed":
                place = f"{segment:0{digits}d}"
                joints.append(
                    _hinge(
                        joint,
                        f"actuator_{index}_joint_{place}",
                        len(bodies) - 1,
                        geometry.subtract(hinge, bodies[-1].origin),
                        index,
                        actuator.channels[segment - 1],
                        actuator.spans[segment - 1],
                    )
                )
                bodies.append(_LinkBuilder(f"actuator_{index}_segment_{place}", hinge))
        solid = link.solid.shortened(fraction)
        bodies[-1].add(link, solid, _inertial(link, fraction), end)
        end += solid.height
        done += fraction
    return end


def _inertial(link: LinkDefinition, fraction: float = 1.0) -> Inertial:
    full = link.inertia or link.solid.inertia(link.mass)
    part = solids.shortened_inertia(link.solid, full, fraction)
    return Inertial(link.mass * fraction, geometry.ZERO, part)


def _hinge(
    joint: JointDefinition,
    name: str,
    parent: int,
    origin: Vector,
    actuator: int,
    channel: int,
    span: float,
) -> Joint:
    return Joint(
        name=name,
        parent=parent,
        origin=origin,
        rpy=geometry.ZERO,
        axis=geometry.unit(joint.axis),
        lower=joint.lower,
        upper=joint.upper,
        effort=joint.effort,
        velocity=joint.velocity,
        stiffness=joint.stiffness,
        damping=joint.damping,
        neutral_position=joint.neutral_position,
        friction=joint.friction,
        actuator=actuator,
        channel=channel,
        span=span,
    )


def _gap_filler(
    link: LinkDefinition, joint: JointDefinition, hinge: Vector, origin: Vector
) -> list[Shape]:
    """Return the shape that fills the gap between two links when their joint bends, or None.

    It is centred on the joint and a solid of revolution about its axis (for a capsule a sphere), so
    that it may be fixed to either link. A joint that only twists opens no gap.
    """
    across = math.hypot(joint.axis[0], joint.axis[1])
    if joint.joint_type == "fixed" or across <= 1e-9 * geometry.norm(joint.axis):
        return []
    at = geometry.subtract(hinge, origin)
    if link.shape_type == "capsule" and isinstance(link.solid, Cylinder):
        ball = Sphere(link.solid.radius)
        return [Shape(ball, at, geometry.ZERO, link.material, link.visual_factor)]
    if link.shape_type == "stadium" and isinstance(link.solid, Box):
        along = (joint.axis[0] / across, joint.axis[1] / across)
        roll, rpy = _inscribed_cylinder(link.solid, along)
        return [Shape(roll, at, rpy, link.material, link.visual_factor)]
    return []


def _inscribed_cylinder(box: Box, along: tuple[float, float]) -> tuple[Cylinder, Vector]:
    """Return a cylinder in a box, along a direction of its cross-section, and its roll, pitch, yaw.

    Along x or y it fills the box. Along other directions the ratio of its length and width is that
    of the chords through the middle, and its corners touch the sides of the box.
    """
    (x, y, _), (ax, ay) = box.size, (abs(along[0]), abs(along[1]))
    length = min(x / ax if ax > 1e-9 else math.inf, y / ay if ay > 1e-9 else math.inf)
    width = min(x / ay if ay > 1e-9 else math.inf, y / ax if ax > 1e-9 else math.inf)
    fit = min(x / (length * ax + width * ay), y / (length * ay + width * ax))
    length, width = fit * length, fit * width
    # rpy (0, π/2, yaw) takes z, the axis of a URDF cylinder, to (cos yaw, sin yaw, 0)
    return Cylinder(length, width / 2), (0.0, math.pi / 2, math.atan2(along[1], along[0]))


def _add_rounded_end(
    body: _LinkBuilder, part: LinkDefinition, start: float, at_base: bool
) -> float:
    """Add a base or tip, with a round free end if its shape has one; return its end height."""
    body.add(part, part.solid, _inertial(part), start)
    _add_end_cap(body, part, body.shapes[-1].position, at_base)
    return start + part.height


def _add_end_cap(body: _LinkBuilder, part: LinkDefinition, centre: Vector, at_base: bool) -> None:
    """Add the round end of a stadium or capsule whose solid is centred at `centre`."""
    if part.shape_type not in ("stadium", "capsule"):
        return
    rotation = geometry.rotation_from_rpy(part.offset_rpy)
    face = -part.height / 2 if at_base else part.height / 2
    at = geometry.add(centre, geometry.rotate(rotation, (0.0, 0.0, face)))
    if isinstance(part.solid, Cylinder):
        cap: Solid = Sphere(part.solid.radius)
        rpy = geometry.ZERO
    elif isinstance(part.solid, Box):
        cap = Cylinder(part.solid.size[0], part.solid.size[1] / 2)
        # the cylinder lies along the part's own x axis: R(rpy) · Ry(π/2)
        rpy = geometry.rpy_from_rotation(
            geometry.multiply(rotation, geometry.rotation_from_rpy((0.0, math.pi / 2, 0.0)))
        )
    else:
        return
    body.shapes.append(Shape(cap, at, rpy, part.material, part.visual_factor))
