"""Box, cylinder and sphere: their height along the backbone, inertia, and parts."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TypeAlias

from somo_cli.manipulator import geometry, hull, round_solids
from somo_cli.manipulator.dimensions import (
    InertiaTensor,
    Length,
    Mass,
    Position,
)
from somo_cli.manipulator.geometry import Matrix, Tensor
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.round_solids import Capsule, RoundedBox


@dataclass(frozen=True, slots=True)
class Box:
    """A box centred on its frame, with edges `size` along x, y and z."""

    size: tuple[Length, Length, Length]


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder centred on its frame, along z."""

    length: Length
    radius: Length


@dataclass(frozen=True, slots=True)
class Sphere:
    """A sphere centred on its frame."""

    radius: Length


Solid: TypeAlias = Box | Cylinder | Sphere
AnySolid: TypeAlias = Solid | Capsule | RoundedBox | Hull
"""What a manipulator is made of, and what else an object can be."""


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, centre of mass, and the inertia about the centre of mass, in one frame's axes."""

    mass: Mass
    centre: Position
    inertia: InertiaTensor


def height(solid: AnySolid) -> float:
    """Return the extent along z, the direction of the backbone."""
    if isinstance(solid, Hull):
        return hull.height(solid)
    if isinstance(solid, Capsule):
        return solid.length + 2 * solid.radius
    if isinstance(solid, Box | RoundedBox):
        return solid.size[2]
    if isinstance(solid, Cylinder):
        return solid.length
    return 2 * solid.radius


def circumradius(solid: AnySolid) -> float:
    """Return how far from the origin of its frame the farthest point of a solid is."""
    if isinstance(solid, Hull):
        return max(map(geometry.norm, solid.vertices))
    if isinstance(solid, Capsule):
        return solid.length / 2 + solid.radius
    if isinstance(solid, RoundedBox):
        return geometry.norm(solid.core) + solid.radius
    if isinstance(solid, Box):
        return geometry.norm(solid.size) / 2
    if isinstance(solid, Cylinder):
        return math.hypot(solid.length / 2, solid.radius)
    return solid.radius


def volume(solid: Solid | Capsule | RoundedBox) -> float:
    """Return the volume."""
    if isinstance(solid, Capsule | RoundedBox):
        return round_solids.volume(solid)
    if isinstance(solid, Box):
        return math.prod(solid.size)
    if isinstance(solid, Cylinder):
        return math.pi * solid.radius**2 * solid.length
    return 4 / 3 * math.pi * solid.radius**3


def part(solid: Solid, fraction: float) -> Solid:
    """Return the solid at this fraction of its height, such as a half; a sphere of its radius."""
    if isinstance(solid, Box):
        return replace(solid, size=(solid.size[0], solid.size[1], solid.size[2] * fraction))
    if isinstance(solid, Cylinder):
        return replace(solid, length=solid.length * fraction)
    return replace(solid, radius=solid.radius * fraction)


def inertia(solid: Solid | Capsule | RoundedBox, mass: float) -> Tensor:
    """Return the inertia of a homogeneous solid about its centre.

    Goldstein, Classical Mechanics, 3rd ed., chapter 5; any table of moments of inertia.
    """
    if isinstance(solid, Capsule | RoundedBox):
        return round_solids.inertia(solid, mass)
    if isinstance(solid, Box):
        x, y, z = solid.size
        moments = (mass * (y * y + z * z) / 12, mass * (x * x + z * z) / 12)
        return (moments[0], 0.0, 0.0, moments[1], 0.0, mass * (x * x + y * y) / 12)
    if isinstance(solid, Cylinder):
        across = mass * (3 * solid.radius**2 + solid.length**2) / 12
        return (across, 0.0, 0.0, across, 0.0, mass * solid.radius**2 / 2)
    moment = 0.4 * mass * solid.radius**2
    return (moment, 0.0, 0.0, moment, 0.0, moment)


def part_inertia(solid: Solid, full: Tensor, fraction: float) -> Tensor:
    """Return the inertia of `part(solid, f)` at f times the mass, when the full solid has `full`.

    The part is the full body squeezed by a linear map A at equal density, up to a factor on the
    mass, so its second moments S = ∫ρ r rᵀ are f A S A; inertia and second moments are related
    by I = tr(S) 1 - S. For a homogeneous solid this equals `inertia(part(solid, f), f * mass)`.
    """
    if fraction == 1:
        return full
    across = fraction if isinstance(solid, Sphere) else 1.0
    squeeze = (across, across, fraction)
    xx, xy, xz, yy, yz, zz = full
    half_trace = (xx + yy + zz) / 2
    s_xx = fraction * (half_trace - xx) * squeeze[0] ** 2
    s_yy = fraction * (half_trace - yy) * squeeze[1] ** 2
    s_zz = fraction * (half_trace - zz) * squeeze[2] ** 2
    return (
        s_yy + s_zz,
        fraction * xy * squeeze[0] * squeeze[1],
        fraction * xz * squeeze[0] * squeeze[2],
        s_xx + s_zz,
        fraction * yz * squeeze[1] * squeeze[2],
        s_xx + s_yy,
    )


def placed(inertial: Inertial, position: geometry.Vector, rotation: Matrix) -> Inertial:
    """Return `inertial` seen from a frame in which its own frame has this pose."""
    return Inertial(
        inertial.mass,
        geometry.add(position, geometry.rotate(rotation, inertial.centre)),
        geometry.rotated_tensor(inertial.inertia, rotation),
    )


def lumped(parts: tuple[Inertial, ...]) -> Inertial:
    """Return one rigid body of several that share a frame (Steiner's theorem)."""
    # fsum, because sum rounds in another way from Python 3.12 on, and the bytes shall be the same
    mass = math.fsum(part.mass for part in parts)
    x, y, z = (math.fsum(part.mass * part.centre[i] for part in parts) / mass for i in range(3))
    centre = (x, y, z)
    total = [0.0] * 6
    for part in parts:
        shift = geometry.point_mass_inertia(part.mass, geometry.subtract(part.centre, centre))
        for i in range(6):
            total[i] += part.inertia[i] + shift[i]
    return Inertial(mass, centre, (total[0], total[1], total[2], total[3], total[4], total[5]))
