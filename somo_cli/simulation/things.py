"""Objects of a scene, fixed or free: rigid bodies, which nothing of ours drives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import (
    Angle,
    AngularRate,
    Length,
    Velocity,
)
from somo_cli.simulation import thing_shapes
from somo_cli.simulation.motion import Motion, motion
from somo_cli.simulation.surface import Surface, surface

Reading = Literal["pose", "velocity", "angles", "contact_force", "contact_pairs"]


@dataclass(frozen=True, slots=True)
class Place:
    """What an object stands on, ground or another object by its name, and how far above it."""

    on: str
    gap: Length


@dataclass(frozen=True, slots=True)
class Thing:
    """An object: a chain of one link, and how it starts, in the world.

    The pose is that of its frame, the velocity that of its centre of mass. With a place the height
    of its position is not yet known; see `placing`.
    """

    name: str
    chain: Chain
    is_fixed: bool
    position: tuple[Length, Length, Length]
    rpy: tuple[Angle, Angle, Angle]
    linear_velocity: tuple[Velocity, Velocity, Velocity]
    angular_velocity: tuple[AngularRate, AngularRate, AngularRate]
    surface: Surface
    motion: Motion | None = None
    place: Place | None = None

    @property
    def is_held(self) -> bool:
        """Whether nothing that touches it moves it."""
        return self.is_fixed or self.motion is not None


def place(data: Mapping[str, Any]) -> Place:
    """Return the place that a sound mapping describes."""
    return Place(str(data["on"]), float(data.get("gap", 0)))


def thing(data: Mapping[str, Any]) -> Thing:
    """Return the object that a sound mapping describes."""
    name = str(data["name"])
    link = thing_shapes.link(data)
    height = max(solids.height(shape.solid) for shape in link.shapes)
    return Thing(
        name=name,
        chain=Chain(name, (link,), (), geometry.ZERO, height),
        is_fixed=bool(data.get("fixed", False)),
        position=geometry.vector(data.get("position", (0, 0, 0))),
        rpy=geometry.vector(data.get("rpy", (0, 0, 0))),
        linear_velocity=geometry.vector(data.get("linear_velocity", (0, 0, 0))),
        angular_velocity=geometry.vector(data.get("angular_velocity", (0, 0, 0))),
        surface=surface(data),
        motion=motion(data["motion"]) if "motion" in data else None,
        place=place(data["place"]) if "place" in data else None,
    )
