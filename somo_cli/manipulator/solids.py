"""Box, cylinder and sphere, the solids of manipulators, and the inertia of rigid bodies.

All solids, including those of objects only, have `height`, `smallest_extent`, `circumradius` and
`reach`; all but hulls have `volume` and `inertia`. Inertias: Goldstein, Classical Mechanics, 3rd
ed., chapter 5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import (
    InertiaTensor,
    Length,
    Mass,
    Position,
)
from somo_cli.manipulator.geometry import Matrix, Tensor, Vector
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.round_solids import Capsule, RoundedBox


@dataclass(frozen=True, slots=True)
class Box:
    """A box centred on its frame, with edges `size` along x, y and z."""

    size: tuple[Length, Length, Length]

    @property
    def height(self) -> float:
        """The extent along z."""
        return self.size[2]

    @property
    def smallest_extent(self) -> float:
        """The shortest edge."""
        return min(self.size)

    @property
    def circumradius(self) -> float:
        """The distance of the farthest point from the origin of the frame."""
        return geometry.norm(self.size) / 2

    @property
    def volume(self) -> float:
        """The volume."""
        return math.prod(self.size)

    def inertia(self, mass: float) -> Tensor:
        """Return the inertia of a homogeneous box of this mass about its centre."""
        x, y, z = self.size
        moments = (mass * (y * y + z * z) / 12, mass * (x * x + z * z) / 12)
        return (moments[0], 0.0, 0.0, moments[1], 0.0, mass * (x * x + y * y) / 12)

    def reach(self, direction: Vector) -> float:
        """Return the farthest extent from the origin along a unit direction in its own axes."""
        return sum(abs(d) * edge / 2 for d, edge in zip(direction, self.size, strict=True))

    def widened(self, factor: float) -> Box:
        """Return the box with this factor on its edges along x and y."""
        x, y, z = self.size
        return replace(self, size=(x * factor, y * factor, z))

    def shortened(self, fraction: float) -> Box:
        """Return the box at this fraction of its height."""
        return replace(self, size=(self.size[0], self.size[1], self.size[2] * fraction))


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder centred on its frame, along z."""

    length: Length
    radius: Length

    @property
    def height(self) -> float:
        """The extent along z."""
        return self.length

    @property
    def smallest_extent(self) -> float:
        """The length or the diameter, whichever is smaller."""
        return min(self.length, 2 * self.radius)

    @property
    def circumradius(self) -> float:
        """The distance of the farthest point from the origin of the frame."""
        return math.hypot(self.length / 2, self.radius)

    @property
    def volume(self) -> float:
        """The volume."""
        return math.pi * self.radius**2 * self.length

    def inertia(self, mass: float) -> Tensor:
        """Return the inertia of a homogeneous cylinder of this mass about its centre."""
        across = mass * (3 * self.radius**2 + self.length**2) / 12
        return (across, 0.0, 0.0, across, 0.0, mass * self.radius**2 / 2)

    def reach(self, direction: Vector) -> float:
        """Return the farthest extent from the origin along a unit direction in its own axes."""
        x, y, z = direction
        return abs(z) * self.length / 2 + math.hypot(x, y) * self.radius

    def widened(self, factor: float) -> Cylinder:
        """Return the cylinder with this factor on its radius."""
        return replace(self, radius=self.radius * factor)

    def shortened(self, fraction: float) -> Cylinder:
        """Return the cylinder at this fraction of its length."""
        return replace(self, length=self.length * fraction)


@dataclass(frozen=True, slots=True)
class Sphere:
    """A sphere centred on its frame."""

    radius: Length

    @property
    def height(self) -> float:
        """The diameter."""
        return 2 * self.radius

    @property
    def smallest_extent(self) -> float:
        """The diameter."""
        return 2 * self.radius

    @property
    def circumradius(self) -> float:
        """The radius."""
        return self.radius

    @property
    def volume(self) -> float:
        """The volume."""
        return 4 / 3 * math.pi * self.radius**3

    def inertia(self, mass: float) -> Tensor:
        """Return the inertia of a homogeneous sphere of this mass about its centre."""
        moment = 0.4 * mass * self.radius**2
        return (moment, 0.0, 0.0, moment, 0.0, moment)

    def reach(self, direction: Vector) -> float:
        """Return the radius: a sphere reaches as far in every direction."""
        return self.radius

    def shortened(self, fraction: float) -> Sphere:
        """Return the sphere of this fraction of the radius."""
        return replace(self, radius=self.radius * fraction)


Solid: TypeAlias = Box | Cylinder | Sphere
AnySolid: TypeAlias = Solid | Capsule | RoundedBox | Hull
"""The solids of manipulators, and those that only objects have."""


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, centre of mass, and inertia about the centre of mass along the axes of one frame."""

    mass: Mass
    centre: Position
    inertia: InertiaTensor


def shortened_inertia(solid: Solid, full: Tensor, fraction: float) -> Tensor:
    """Return the inertia of `solid.shortened(f)` at f times the mass; `full` is that of the solid.

    The short body is the full one compressed by a linear map A, with its mass scaled by f: its
    second moments S = ∫ρ r rᵀ become f A S A. The inertia is I = tr(S) 1 - S. For a homogeneous
    solid the result equals `solid.shortened(f).inertia(f * mass)`.
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


def placed(inertial: Inertial, position: Vector, rotation: Matrix) -> Inertial:
    """Return an inertial in another frame, in which the inertial's own frame has this pose."""
    return Inertial(
        inertial.mass,
        geometry.add(position, geometry.rotate(rotation, inertial.centre)),
        geometry.rotated_tensor(inertial.inertia, rotation),
    )


def lumped(parts: tuple[Inertial, ...]) -> Inertial:
    """Return the inertial of several bodies in one frame as one rigid body (Steiner's theorem)."""
    # fsum, because sum rounds differently since Python 3.12, and URDFs must not depend on it
    mass = math.fsum(part.mass for part in parts)
    x, y, z = (math.fsum(part.mass * part.centre[i] for part in parts) / mass for i in range(3))
    centre = (x, y, z)
    total = [0.0] * 6
    for part in parts:
        shift = geometry.point_mass_inertia(part.mass, geometry.subtract(part.centre, centre))
        for i in range(6):
            total[i] += part.inertia[i] + shift[i]
    return Inertial(mass, centre, (total[0], total[1], total[2], total[3], total[4], total[5]))
