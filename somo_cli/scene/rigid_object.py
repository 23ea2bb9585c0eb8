"""Objects of a scene: rigid bodies that are fixed, free or moved by a prescribed motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import (
    Angle,
    AngularRate,
    Length,
    Velocity,
)
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import object_shapes
from somo_cli.scene.contact_surface import ContactSurface, read_surface
from somo_cli.scene.prescribed_motion import PrescribedMotion, read_motion, start_pose_of
from somo_cli.scene.sorotraj import Trajectory

ObjectQuantity = Literal["pose", "velocity", "angles", "contact_force", "contact_pairs"]


@dataclass(frozen=True, slots=True)
class Placement:
    """The name of what an object stands on, ground or another object, and the gap [m] above it."""

    on: str
    gap: Length


@dataclass(frozen=True, slots=True)
class RigidObject:
    """An object: a chain of one link, and its state at the start in the world frame.

    `position` and `rpy` are those of the object's frame; `linear_velocity` is that of its centre of
    mass. With a `placement`, `scene.placement` computes the z of the position later.
    """

    name: str
    chain: Chain
    is_fixed: bool
    position: tuple[Length, Length, Length]
    rpy: tuple[Angle, Angle, Angle]
    linear_velocity: tuple[Velocity, Velocity, Velocity]
    angular_velocity: tuple[AngularRate, AngularRate, AngularRate]
    surface: ContactSurface
    motion: PrescribedMotion | None = None
    placement: Placement | None = None
    collides: bool = True
    """Whether other bodies can touch the object; if not, it is only drawn and recorded."""
    mended_inertias: str = ""
    """Which inertias of its file rounding had made impossible, and what is used in their place."""

    @property
    def pose(self) -> Pose:
        """The pose of the object's frame in the world at the start."""
        return Pose.of(self.position, self.rpy)

    @property
    def has_prescribed_pose(self) -> bool:
        """Whether contact cannot move the object: it is fixed or has a prescribed motion."""
        return self.is_fixed or self.motion is not None


def read_placement(data: Mapping[str, Any]) -> Placement:
    """Return the placement from a `place` mapping without errors."""
    return Placement(str(data["on"]), float(data.get("gap", 0)))


def read_object(
    data: Mapping[str, Any], trajectories: Mapping[str, Trajectory] | None = None
) -> RigidObject:
    """Return the object from a mapping without errors, in a scene with these trajectories."""
    name = str(data["name"])
    motion = read_motion(data["motion"], trajectories) if "motion" in data else None
    position, rpy = start_pose_of(data, motion)
    link = object_shapes.object_link(data)
    height = max(shape.solid.height for shape in link.shapes)
    return RigidObject(
        name=name,
        chain=Chain(name, (link,), (), geometry.ZERO, height),
        is_fixed=bool(data.get("fixed", False)),
        position=position,
        rpy=rpy,
        linear_velocity=geometry.vector(data.get("linear_velocity", (0, 0, 0))),
        angular_velocity=geometry.vector(data.get("angular_velocity", (0, 0, 0))),
        surface=read_surface(data),
        motion=motion,
        collides=bool(data.get("collides", True)),
        mended_inertias=object_shapes.mended_inertias(data),
        placement=read_placement(data["place"]) if "place" in data else None,
    )
