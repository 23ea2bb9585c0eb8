"""What an object is made of: its shapes and its inertia, in its frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Link, Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.read import solid_from
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import AnySolid, Inertial, Solid

FIXED_MASS = 1.0  # kg, of what cannot move and so needs none
_MATERIAL = Material("object", (0.8, 0.6, 0.3, 1.0))


def link(data: Mapping[str, Any]) -> Link:
    """Return the one link of the object that a sound mapping describes."""
    solid = solid_of(data)
    mass = _mass(data, solids.volume(solid))
    inertial = Inertial(mass, geometry.ZERO, solids.inertia(solid, mass))
    return Link("object", inertial, (placed(solid),))


def solid_of(data: Mapping[str, Any]) -> Solid | Capsule | RoundedBox:
    """Return the solid of a `shape_type` that has `dimensions`."""
    dimensions = [float(value) for value in data["dimensions"]]
    if data["shape_type"] == "capsule":
        return Capsule(dimensions[0], dimensions[1])
    if data.get("edge_radius", 0) > 0:
        return RoundedBox(geometry.vector(dimensions), float(data["edge_radius"]))
    return solid_from(data["shape_type"], dimensions)


def placed(
    solid: AnySolid,
    position: geometry.Vector = geometry.ZERO,
    rpy: geometry.Vector = geometry.ZERO,
) -> Shape:
    """Return a shape of an object: the solid at a pose in the object's frame."""
    return Shape(solid, position, rpy, _MATERIAL, 1.0)


def _mass(data: Mapping[str, Any], volume: float) -> float:
    if "density" in data:
        return float(data["density"]) * volume
    return float(data.get("mass", FIXED_MASS))
