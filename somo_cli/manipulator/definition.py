"""The definition of a manipulator, as a file gives it. The backbone points along +z.

Quantities are in the units of the file: SI if it has a `world_scale`. Files of SoMo have a world
scale of 1 and are in units that SoMo calls simulation units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from somo_cli.manipulator.dimensions import (
    Angle,
    AngularRate,
    Damping,
    Direction,
    InertiaTensor,
    Length,
    Mass,
    Number,
    Position,
    RollPitchYaw,
    Scale,
    Stiffness,
    Torque,
    TorquePerPressure,
)
from somo_cli.manipulator.solids import Solid

ShapeType = Literal["box", "cylinder", "sphere", "stadium", "capsule"]
JointType = Literal["revolute", "continuous", "fixed"]
Placement = Literal["uniform", "gauss"]

MAXIMUM_JOINTS = 121
"""PyBullet 3.2.7 silently ignores every command to joints of a body after the 121st."""


@dataclass(frozen=True, slots=True)
class Material:
    """A colour and its name; red, green, blue and opacity are from 0 to 1."""

    name: str
    rgba: tuple[Number, Number, Number, Number]


@dataclass(frozen=True, slots=True)
class LinkDefinition:
    """A rigid body of a primitive shape, centred on the backbone and then moved by its offset.

    `solid` is the part that has the mass: in a stadium the box between the round ends, in a capsule
    the cylinder between its caps. Without an `inertia` the solid is homogeneous.
    """

    shape_type: ShapeType
    solid: Solid
    mass: Mass
    inertia: InertiaTensor | None
    material: Material
    offset: Position
    offset_rpy: RollPitchYaw
    visual_factor: Number

    @property
    def height(self) -> float:
        """The extent along the backbone."""
        return self.solid.height


@dataclass(frozen=True, slots=True)
class JointDefinition:
    """A revolute joint with spring, damper and dry friction; `offset` moves it off the backbone.

    `torque_per_pressure` is None if the file does not give it.
    """

    joint_type: JointType
    axis: Direction
    lower: Angle
    upper: Angle
    effort: Torque
    velocity: AngularRate
    stiffness: Stiffness
    damping: Damping
    neutral_position: Angle
    friction: Torque
    torque_per_pressure: TorquePerPressure | None
    offset: Position


@dataclass(frozen=True, slots=True)
class ActuatorDefinition:
    """`n_segments` joints between links of one shape, base to tip.

    For each joint, `joints` has its properties as if it were evenly placed, `channels` the axis of
    the actuator that drives it, and `spans` the length of backbone that it represents; `shares` has
    that length divided by an evenly placed joint's. `fractions` has the length of each link divided
    by that of `link`; there is one link more than joints. With even placement both end links are
    half links.
    """

    link: LinkDefinition
    placement: Placement
    joints: tuple[JointDefinition, ...]
    channels: tuple[int, ...]
    spans: tuple[Length, ...]
    shares: tuple[Number, ...]
    fractions: tuple[Number, ...]
    taper: Number = 1.0
    """Width at the end over that at the start; `link` and `joints` are those of the start."""

    @property
    def n_segments(self) -> int:
        """The number of joints, `n_segments` in SoMo."""
        return len(self.joints)


@dataclass(frozen=True, slots=True)
class LimbDefinition:
    """One manipulator of an assembly: its name, pose, base and tips.

    `position` and `rpy` are the pose of its base frame in the frame of the body. Its actuators are
    the next `n_actuators` of the assembly's actuators.
    """

    name: str
    position: Position
    rpy: RollPitchYaw
    base: LinkDefinition | None
    n_actuators: int
    tips: tuple[LinkDefinition, ...]


@dataclass(frozen=True, slots=True)
class Definition:
    """A manipulator: an optional base, actuators in series and any number of tips.

    An assembly has `limbs` as well: `base` is then its body, `actuators` has those of all limbs,
    limb after limb and each from base to tip, and the limbs have the tips.
    """

    name: str
    urdf_filename: str | None
    base: LinkDefinition | None
    actuators: tuple[ActuatorDefinition, ...]
    tips: tuple[LinkDefinition, ...]
    limbs: tuple[LimbDefinition, ...] = ()

    def actuators_of(self, limb: str) -> range:
        """Return the numbers of a limb's actuators. Raises KeyError for an unknown limb."""
        first = 0
        for one in self.limbs:
            if one.name == limb:
                return range(first, first + one.n_actuators)
            first += one.n_actuators
        raise KeyError(limb)


WorldScale: TypeAlias = Scale | None
"""None if the file does not give it: the scale is then 1."""
