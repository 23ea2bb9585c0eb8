"""Capsule and rounded box, with volume and inertia in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Length
from somo_cli.manipulator.geometry import Tensor, Vector


@dataclass(frozen=True, slots=True)
class Capsule:
    """A cylinder along z with a half sphere on each end, centred on its frame.

    `length` is that of the cylinder alone, between the centres of both half spheres.
    """

    length: Length
    radius: Length

    @property
    def height(self) -> float:
        """The extent along z, with both half spheres."""
        return self.length + 2 * self.radius

    @property
    def smallest_extent(self) -> float:
        """The diameter."""
        return 2 * self.radius

    @property
    def circumradius(self) -> float:
        """The distance of the farthest point from the origin of the frame."""
        return self.length / 2 + self.radius

    @property
    def volume(self) -> float:
        """The volume."""
        r = self.radius
        return math.pi * r * r * self.length + 4 / 3 * math.pi * r**3

    def inertia(self, mass: float) -> Tensor:
        """Return the inertia of a homogeneous capsule of this mass about its centre."""
        length, r = self.length, self.radius
        density = mass / self.volume
        middle, ends = density * math.pi * r * r * length, density * 4 / 3 * math.pi * r**3
        along = middle * r * r / 2 + ends * 2 / 5 * r * r
        # the centre of a half sphere is 3/8 r beyond its flat face; Steiner's term about the middle
        across = middle * (length**2 / 12 + r * r / 4)
        across += ends * (2 / 5 * r * r + length**2 / 4 + 3 / 8 * length * r)
        return (across, 0.0, 0.0, across, 0.0, along)

    def reach(self, direction: Vector) -> float:
        """Return the farthest extent from the origin along a unit direction in its own axes."""
        return abs(direction[2]) * self.length / 2 + self.radius


@dataclass(frozen=True, slots=True)
class RoundedBox:
    """A box centred on its frame, with edges and corners rounded with one radius.

    `size` is that of the bounding box. The body is the Minkowski sum of a smaller box, its core,
    and a ball of this radius.
    """

    size: tuple[Length, Length, Length]
    radius: Length

    @property
    def core(self) -> tuple[float, float, float]:
        """The half edges of the core."""
        x, y, z = (edge / 2 - self.radius for edge in self.size)
        return (x, y, z)

    @property
    def height(self) -> float:
        """The extent along z."""
        return self.size[2]

    @property
    def smallest_extent(self) -> float:
        """The shortest edge of the bounding box."""
        return min(self.size)

    @property
    def circumradius(self) -> float:
        """The distance of the farthest point from the origin of the frame."""
        return geometry.norm(self.core) + self.radius

    @property
    def volume(self) -> float:
        """The volume, by Steiner's formula: V + S r + M r² + 4/3 π r³ of the core."""
        r = self.radius
        a, b, c = self.core
        faces, edges = 8 * r * (a * b + b * c + c * a), 2 * math.pi * r * r * (a + b + c)
        return 8 * a * b * c + faces + edges + 4 / 3 * math.pi * r**3

    def inertia(self, mass: float) -> Tensor:
        """Return the inertia of a homogeneous rounded box of this mass about its centre."""
        density = mass / self.volume
        x, y, z = self.core
        s_x = density * _second_moment(x, y, z, self.radius)
        s_y = density * _second_moment(y, z, x, self.radius)
        s_z = density * _second_moment(z, x, y, self.radius)
        return (s_y + s_z, 0.0, 0.0, s_z + s_x, 0.0, s_x + s_y)

    def reach(self, direction: Vector) -> float:
        """Return the farthest extent from the origin along a unit direction in its own axes."""
        core = sum(abs(d) * half for d, half in zip(direction, self.core, strict=True))
        return core + self.radius


def _second_moment(a: float, b: float, c: float, r: float) -> float:
    """Return the integral of x² over a rounded box with a core of half edges a, b, c along x, y, z.

    The body is the core, a slab on each face, a quarter of a cylinder on each edge and an eighth
    of a ball on each corner.
    """
    quarter, eighth = math.pi * r * r / 4, math.pi * r**3 / 6
    inside = 8 * a * b * c + 8 * a * r * (b + c) + 2 * math.pi * r * r * a  # as long as the core
    slabs = 8 * b * c * ((a + r) ** 3 - a**3) / 3
    # of a quarter disc ∫u = r³/3 and ∫u² = π r⁴/16; of an eighth of a ball π r⁴/16 and π r⁵/30
    edges = 8 * (b + c) * (a * a * quarter + 2 * a * r**3 / 3 + math.pi * r**4 / 16)
    corners = 8 * (a * a * eighth + a * math.pi * r**4 / 8 + math.pi * r**5 / 30)
    return inside * a * a / 3 + slabs + edges + corners
