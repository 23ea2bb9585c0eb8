"""Objects of a scene, fixed or free: rigid bodies of one solid, which nothing of ours drives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Chain, Link, Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.dimensions import (
    Angle,
    AngularRate,
    Length,
    Velocity,
)
from somo_cli.manipulator.read import solid_from
from somo_cli.manipulator.solids import Inertial
from somo_cli.simulation.motion import Motion, motion
from somo_cli.simulation.surface import Surface

Reading = Literal["pose", "contact_force"]

FIXED_MASS = 1.0  # kg, of what cannot move and so needs none
_MATERIAL = Material("object", (0.8, 0.6, 0.3, 1.0))


@dataclass(frozen=True, slots=True)
class Place:
    """What an object stands on, ground or another object by its name, and how far above it."""

    on: str
    gap: Length


@dataclass(frozen=True, slots=True)
class Thing:
    """An object: a chain of one link, centred on its frame, and how it starts, in the world.

    With a place the height of its position is not yet known; see `placing`.
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
    """Return the object that a sound mapping describes; its inertia is that of the solid."""
    name = str(data["name"])
    solid = solid_from(data["shape_type"], [float(value) for value in data["dimensions"]])
    mass = float(data.get("mass", FIXED_MASS))
    inertial = Inertial(mass, geometry.ZERO, solids.inertia(solid, mass))
    shape = Shape(solid, geometry.ZERO, geometry.ZERO, _MATERIAL, 1.0)
    link = Link("object", inertial, (shape,))
    return Thing(
        name=name,
        chain=Chain(name, (link,), (), geometry.ZERO, solids.height(solid)),
        is_fixed=bool(data.get("fixed", False)),
        position=geometry.vector(data.get("position", (0, 0, 0))),
        rpy=geometry.vector(data.get("rpy", (0, 0, 0))),
        linear_velocity=geometry.vector(data.get("linear_velocity", (0, 0, 0))),
        angular_velocity=geometry.vector(data.get("angular_velocity", (0, 0, 0))),
        surface=Surface(float(data.get("friction", 0.5))),
        motion=motion(data["motion"]) if "motion" in data else None,
        place=place(data["place"]) if "place" in data else None,
    )
