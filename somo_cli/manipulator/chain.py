"""Definition to Chain: rigid links and the joints between them, parent first.

Everything that a fixed joint would join is lumped into one link here, because PyBullet's own
merging (URDF_MERGE_FIXED_LINKS, seen in 3.2.7) drops the parts' centres of mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.definition import (
    ActuatorDefinition,
    Definition,
    JointDefinition,
    LinkDefinition,
    Material,
)
from somo_cli.manipulator.dimensions import (
    Angle,
    AngularRate,
    Damping,
    Direction,
    Length,
    Number,
    Position,
    RollPitchYaw,
    Stiffness,
    Torque,
)
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.joint_placement import scaled_to_share
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Inertial, Solid, Sphere


@dataclass(frozen=True, slots=True)
class Shape:
    """A solid with its pose in the frame of its link."""

    solid: AnySolid
    position: Position
    rpy: RollPitchYaw
    material: Material
    visual_factor: Number


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body; its frame sits on the joint that moves it, the root's at the base."""

    name: str
    inertial: Inertial
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Joint:
    """A hinge: joint i turns link `i + 1` by its angle about `axis`, in link `parent`.

    `origin` and `rpy` are the child's frame in the parent's at an angle of zero, `axis` a unit
    vector in the child's. A joint without limits has lower > upper. `actuator` and `channel` say
    what drives it; `span` is the length of backbone the joint stands for, so that angle / span is
    its curvature.
    """

    name: str
    parent: int
    origin: Position
    rpy: RollPitchYaw
    axis: Direction
    lower: Angle
    upper: Angle
    effort: Torque
    velocity: AngularRate
    stiffness: Stiffness
    damping: Damping
    neutral_position: Angle
    friction: Torque
    actuator: int
    channel: int
    span: Length

    @property
    def is_limited(self) -> bool:
        """Whether the joint has limits."""
        return self.lower <= self.upper


@dataclass(frozen=True, slots=True)
class Limb:
    """A backbone of a chain: joints [first, last) in series, the first of them on the root.

    `tip` is where it ends, a point of its last link. Its actuators are numbered from
    `first_actuator` on. The names of its links and joints start with its own and an underscore;
    that of a manipulator by itself is empty.
    """

    name: str
    first: int
    last: int
    first_actuator: int
    tip: Position

    @property
    def prefix(self) -> str:
        """What the names of its links and joints start with."""
        return f"{self.name}_" if self.name else ""

    @property
    def last_link(self) -> int:
        """The link that has the tip."""
        return self.last  # joint i moves link i + 1; the root, where there are no joints


@dataclass(frozen=True, slots=True)
class Chain:
    """Links and joints, parent first: joint i moves link i + 1. `tip` is a point of the last link.

    The tip is where the backbone ends: the distal end of the last segment, on the centreline.
    An assembly has `limbs`, whose joints follow one another; its `length` is the longest limb's.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tip: Position
    length: Length
    limbs: tuple[Limb, ...] = ()

    @property
    def backbones(self) -> tuple[Limb, ...]:
        """The limbs, or for a manipulator by itself the one that it is."""
        return self.limbs or (Limb("", 0, len(self.joints), 0, self.tip),)

    def backbone_of(self, joint: Joint) -> Limb:
        """Return the limb that has the actuator of a joint."""
        return [limb for limb in self.backbones if limb.first_actuator <= joint.actuator][-1]

    def without_limits(self) -> Chain:
        """Return the same chain of joints that have no limits."""
        free = tuple(replace(joint, lower=0.0, upper=-1.0) for joint in self.joints)
        return replace(self, joints=free)


@dataclass(slots=True)
class _LinkBuilder:
    """A link in the making; positions are in the root's frame with all joints at zero."""

    name: str
    origin: Vector
    inertials: list[Inertial] = field(default_factory=list)
    shapes: list[Shape] = field(default_factory=list)

    def add(self, part: LinkDefinition, solid: Solid, inertial: Inertial, start: float) -> None:
        """Add a part whose proximal face is at height `start` on the backbone."""
        at = geometry.subtract((0.0, 0.0, start + solid.height / 2), self.origin)
        at = geometry.add(at, part.offset)
        rotation = geometry.rotation_from_rpy(part.offset_rpy)
        self.inertials.append(solids.placed(inertial, at, rotation))
        self.shapes.append(Shape(solid, at, part.offset_rpy, part.material, part.visual_factor))

    def link(self) -> Link:
        return Link(self.name, solids.lumped(tuple(self.inertials)), tuple(self.shapes))


def build(definition: Definition) -> Chain:
    """Return the chain of a definition without limbs; never fails for one without faults."""
    assert not definition.limbs
    bodies = [_LinkBuilder("base", geometry.ZERO)]
    joints: list[Joint] = []
    end = 0.0
    if definition.base is not None:
        end = _add_rounded_end(bodies[0], definition.base, end, at_base=True)
        if not definition.actuators:  # the body of an assembly, both of whose ends are free
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
    link, end = actuator.link, start
    digits = max(2, len(str(actuator.n_segments)))
    for segment, fraction in enumerate(actuator.fractions):
        if segment > 0:
            joint = scaled_to_share(actuator.joints[segment - 1], actuator.shares[segment - 1])
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
    """Return the shape that fills the gap a bending hinge opens, centred on the hinge.

    It is a body of revolution about the hinge's axis (a sphere for a capsule), so it looks the
    same whichever of the two links it is fixed to. A joint that only twists opens no gap.
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
    """Return a cylinder along a direction of the cross-section that fits into the box.

    Along x or y it fills the box. Askew, its length and width are in the ratio of the chords
    through the middle, and its corners touch a side.
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
    """Add a base or tip; without a hinge to round, a stadium or capsule has its free end round."""
    body.add(part, part.solid, _inertial(part), start)
    _add_end_cap(body, part, body.shapes[-1].position, at_base)
    return start + part.height


def _add_end_cap(body: _LinkBuilder, part: LinkDefinition, centre: Vector, at_base: bool) -> None:
    """Add what rounds an end of a part whose solid is centred there; others get nothing."""
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
