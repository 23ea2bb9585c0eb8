"""The manipulator as a file describes it. The backbone runs along +z.

Quantities are in the unit of the file: SI if it has a `world_scale`. Files of SoMo have a world
scale of 1, and are in what SoMo calls simulation units.
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
"""PyBullet 3.2.7 silently ignores every command to the 122nd joint of a body and beyond."""


@dataclass(frozen=True, slots=True)
class Material:
    """A colour and its name; red, green, blue and opacity from 0 to 1."""

    name: str
    rgba: tuple[Number, Number, Number, Number]


@dataclass(frozen=True, slots=True)
class LinkDefinition:
    """A rigid body of a primitive shape, centred on the backbone and then moved by its offset.

    `solid` is the part that has the mass: of a stadium the box between the round ends, of a
    capsule the cylinder between its caps. Without an `inertia` the solid is homogeneous.
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
    """A hinge with a spring, a damper and dry friction; `offset` moves it off the backbone.

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

    For each joint, `joints` has its properties if it were evenly placed, `channels` the axis of the
    actuator that drives it, and `spans` the length of backbone that it represents; `shares` is that
    length relative to an evenly placed joint's. `fractions` has the lengths of the links relative
    to `link`, one more than there are joints; with even placement both end links are halves.
    """

    link: LinkDefinition
    placement: Placement
    joints: tuple[JointDefinition, ...]
    channels: tuple[int, ...]
    spans: tuple[Length, ...]
    shares: tuple[Number, ...]
    fractions: tuple[Number, ...]

    @property
    def n_segments(self) -> int:
        """Number of joints, SoMo's `n_segments`."""
        return len(self.joints)


@dataclass(frozen=True, slots=True)
class LimbDefinition:
    """One manipulator of an assembly: its name, pose, base and tips.

    `position` and `rpy` are the pose of its base frame in the frame of the body. Its actuators are
    the next `n_actuators` of the assembly's.
    """

    name: str
    position: Position
    rpy: RollPitchYaw
    base: LinkDefinition | None
    n_actuators: int
    tips: tuple[LinkDefinition, ...]


@dataclass(frozen=True, slots=True)
class Definition:
    """A manipulator, which has an optional base, actuators in series and any number of tips.

    Or an assembly, which has limbs: `base` is then its body, `actuators` has those of all limbs,
    limb after limb, each base to tip, and the tips are in the limbs.
    """

    name: str
    urdf_filename: str | None
    base: LinkDefinition | None
    actuators: tuple[ActuatorDefinition, ...]
    tips: tuple[LinkDefinition, ...]
    limbs: tuple[LimbDefinition, ...] = ()

    def actuators_of(self, limb: str) -> range:
        """Return the numbers of the actuators of a limb; raise KeyError without it."""
        first = 0
        for one in self.limbs:
            if one.name == limb:
                return range(first, first + one.n_actuators)
            first += one.n_actuators
        raise KeyError(limb)


WorldScale: TypeAlias = Scale | None
"""None if the file does not give it: the scale is then 1."""
