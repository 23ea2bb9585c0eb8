"""Chains: rigid links and the joints between them, parents before children."""

from __future__ import annotations

from dataclasses import dataclass, replace

from somo_cli.manipulator.definition import (
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
from somo_cli.manipulator.solids import AnySolid, Inertial


@dataclass(frozen=True, slots=True)
class Shape:
    """A solid with its pose in the link frame, its material and the scale of its drawing."""

    solid: AnySolid
    position: Position
    rpy: RollPitchYaw
    material: Material
    visual_factor: Number


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body. Its frame is at the joint that moves it; the root's frame is the base frame."""

    name: str
    inertial: Inertial
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class Joint:
    """A revolute joint: joint i rotates link i + 1, its child, relative to link `parent`.

    `origin` and `rpy` are the pose of the child's frame in the parent's at an angle of zero; `axis`
    is a unit vector in the child's frame. A joint without limits has lower > upper. `actuator` and
    `channel` are the actuator that drives it and its axis. `span` is the length of backbone that
    the joint represents: angle / span is its curvature.
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

    `tip` is the end of the backbone, in the frame of the last link. Its actuators are numbered from
    `first_actuator` on. Names of its links and joints start with its name and an underscore; the
    only backbone of a manipulator that is not an assembly has no name.
    """

    name: str
    first: int
    last: int
    first_actuator: int
    tip: Position

    @property
    def prefix(self) -> str:
        """The start of the names of its links and joints."""
        return f"{self.name}_" if self.name else ""

    @property
    def last_link(self) -> int:
        """The number of the link that has the tip."""
        return self.last  # joint i moves link i + 1; without joints it is the root


@dataclass(frozen=True, slots=True)
class Chain:
    """Links and joints, parents first: joint i moves link i + 1.

    `tip` is the end of the backbone in the frame of the last link: the distal end of the last
    segment, on the centreline. An assembly has `limbs`, limb after limb, and the length of the
    longest one.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    tip: Position
    length: Length
    limbs: tuple[Limb, ...] = ()

    @property
    def backbones(self) -> tuple[Limb, ...]:
        """The limbs of an assembly, or the only backbone of another manipulator."""
        return self.limbs or (Limb("", 0, len(self.joints), 0, self.tip),)

    @property
    def neutral_angles(self) -> tuple[float, ...]:
        """The angle of every joint at which its spring is relaxed [rad]."""
        return tuple(joint.neutral_position for joint in self.joints)

    def backbone_of(self, joint: Joint) -> Limb:
        """Return the limb that has the actuator of a joint."""
        return [limb for limb in self.backbones if limb.first_actuator <= joint.actuator][-1]

    def without_limits(self) -> Chain:
        """Return the chain with the limits of all joints removed."""
        free = tuple(replace(joint, lower=0.0, upper=-1.0) for joint in self.joints)
        return replace(self, joints=free)
