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
from somo_cli.simulation.surface import Surface, surface

Reading = Literal["pose", "velocity", "angles", "contact_force", "contact_pairs"]


@dataclass(frozen=True, slots=True)
class Thing:
    """An object: a chain of one link, and how it starts, in the world.

    The pose is that of its frame, the velocity that of its centre of mass.
    """

    name: str
    chain: Chain
    is_fixed: bool
    position: tuple[Length, Length, Length]
    rpy: tuple[Angle, Angle, Angle]
    linear_velocity: tuple[Velocity, Velocity, Velocity]
    angular_velocity: tuple[AngularRate, AngularRate, AngularRate]
    surface: Surface


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
    )
