"""The manipulator as a person describes it: frozen dataclasses, lengths along the backbone +z.

Quantities are in the unit of the file: SI, where the file has a `world_scale`; what SoMo calls
simulation units in a SoMo file, whose world scale is 1.
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
"""PyBullet 3.2.7 silently ignores every command to the 122nd joint of a body and later ones."""


@dataclass(frozen=True, slots=True)
class Material:
    """A colour and its name; red, green, blue and opacity from 0 to 1."""

    name: str
    rgba: tuple[Number, Number, Number, Number]


@dataclass(frozen=True, slots=True)
class LinkDefinition:
    """A rigid body of a primitive shape, centred on the backbone but for its offset.

    `solid` is the part that has the mass: for a stadium the box between the rounded ends, for a
    capsule the cylinder between its caps. `inertia` is None where the solid's own is meant.
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
        """BoundingBox along the backbone."""
        return self.solid.height


@dataclass(frozen=True, slots=True)
class JointDefinition:
    """A hinge with a spring, a damper and dry friction; `offset` moves it off the backbone.

    `torque_per_pressure` is None where the actuator's pressure is not known to bend it.
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
    """`n_segments` joints between links of one shape, placed as `placement` says.

    `joints` has one entry per joint, base to tip, each as an evenly placed one would be;
    `channels` says for each which of the actuator's axes drives it, `spans` how much backbone it
    stands for, and `shares` that over what an evenly placed one does. `fractions` holds the
    lengths of the links, one more, over that of `link`; evenly placed, the end links are halves.
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
    """One manipulator of an assembly: its name, its own base and tips, where it is mounted.

    `position` and `rpy` are the pose of its base frame in the body's. It has the next `n_actuators`
    of the actuators of the assembly.
    """

    name: str
    position: Position
    rpy: RollPitchYaw
    base: LinkDefinition | None
    n_actuators: int
    tips: tuple[LinkDefinition, ...]


@dataclass(frozen=True, slots=True)
class Definition:
    """A whole manipulator: an optional base, actuators in series, any number of tips.

    An assembly has limbs as well: then `base` is its body, `actuators` holds those of limb after
    limb, each base to tip, and the tips are the limbs'.
    """

    name: str
    urdf_filename: str | None
    base: LinkDefinition | None
    actuators: tuple[ActuatorDefinition, ...]
    tips: tuple[LinkDefinition, ...]
    limbs: tuple[LimbDefinition, ...] = ()

    def actuators_of(self, limb: str) -> range:
        """Return the numbers of the actuators of the limb of this name."""
        first = 0
        for one in self.limbs:
            if one.name == limb:
                return range(first, first + one.n_actuators)
            first += one.n_actuators
        raise KeyError(limb)


WorldScale: TypeAlias = Scale | None
"""None where the file does not say, which means 1."""
