"""Box, cylinder and sphere: their height along the backbone, inertia, and halves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import (
    InertiaTensor,
    Length,
    Mass,
    Position,
)
from somo_cli.manipulator.geometry import Matrix, Tensor


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


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, centre of mass, and the inertia about the centre of mass, in one frame's axes."""

    mass: Mass
    centre: Position
    inertia: InertiaTensor


def height(solid: Solid) -> float:
    """Return the extent along z, the direction of the backbone."""
    if isinstance(solid, Box):
        return solid.size[2]
    if isinstance(solid, Cylinder):
        return solid.length
    return 2 * solid.radius


def half(solid: Solid) -> Solid:
    """Return the half-length solid that ends an actuator; a sphere has half its radius."""
    if isinstance(solid, Box):
        return replace(solid, size=(solid.size[0], solid.size[1], solid.size[2] / 2))
    if isinstance(solid, Cylinder):
        return replace(solid, length=solid.length / 2)
    return replace(solid, radius=solid.radius / 2)


def inertia(solid: Solid, mass: float) -> Tensor:
    """Return the inertia of a homogeneous solid about its centre.

    Goldstein, Classical Mechanics, 3rd ed., chapter 5; any table of moments of inertia.
    """
    if isinstance(solid, Box):
        x, y, z = solid.size
        moments = (mass * (y * y + z * z) / 12, mass * (x * x + z * z) / 12)
        return (moments[0], 0.0, 0.0, moments[1], 0.0, mass * (x * x + y * y) / 12)
    if isinstance(solid, Cylinder):
        across = mass * (3 * solid.radius**2 + solid.length**2) / 12
        return (across, 0.0, 0.0, across, 0.0, mass * solid.radius**2 / 2)
    moment = 0.4 * mass * solid.radius**2
    return (moment, 0.0, 0.0, moment, 0.0, moment)


def half_inertia(solid: Solid, full: Tensor) -> Tensor:
    """Return the inertia of `half(solid)` at half the mass, when the full solid has `full`.

    The half is the full body squeezed by a linear map A at equal density, up to a factor on the
    mass, so its second moments S = ∫ρ r rᵀ are ½ A S A; inertia and second moments are related
    by I = tr(S) 1 - S. For a homogeneous solid this equals `inertia(half(solid), mass / 2)`.
    """
    across = 0.5 if isinstance(solid, Sphere) else 1.0
    squeeze = (across, across, 0.5)
    xx, xy, xz, yy, yz, zz = full
    half_trace = (xx + yy + zz) / 2
    s_xx = 0.5 * (half_trace - xx) * squeeze[0] ** 2
    s_yy = 0.5 * (half_trace - yy) * squeeze[1] ** 2
    s_zz = 0.5 * (half_trace - zz) * squeeze[2] ** 2
    return (
        s_yy + s_zz,
        0.5 * xy * squeeze[0] * squeeze[1],
        0.5 * xz * squeeze[0] * squeeze[2],
        s_xx + s_zz,
        0.5 * yz * squeeze[1] * squeeze[2],
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
    mass = sum(part.mass for part in parts)
    x, y, z = (sum(part.mass * part.centre[i] for part in parts) / mass for i in range(3))
    centre = (x, y, z)
    total = [0.0] * 6
    for part in parts:
        shift = geometry.point_mass_inertia(part.mass, geometry.subtract(part.centre, centre))
        for i in range(6):
            total[i] += part.inertia[i] + shift[i]
    return Inertial(mass, centre, (total[0], total[1], total[2], total[3], total[4], total[5]))
