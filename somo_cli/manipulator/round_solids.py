"""Capsule and rounded box: their volume and inertia in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

from somo_cli.manipulator.dimensions import Length
from somo_cli.manipulator.geometry import Tensor


@dataclass(frozen=True, slots=True)
class Capsule:
    """A cylinder along z with a half ball on each end, centred on its frame.

    `length` is that of the cylinder alone: from the centre of one half ball to that of the other.
    """

    length: Length
    radius: Length


@dataclass(frozen=True, slots=True)
class RoundedBox:
    """A box centred on its frame whose edges and corners are round, of one radius.

    `size` is that of the box around it; a ball of the radius that rolls inside reaches all of it.
    """

    size: tuple[Length, Length, Length]
    radius: Length

    @property
    def core(self) -> tuple[float, float, float]:
        """The half edges of the box to which the ball is added (Minkowski)."""
        x, y, z = (edge / 2 - self.radius for edge in self.size)
        return (x, y, z)


def volume(solid: Capsule | RoundedBox) -> float:
    """Return the volume."""
    r = solid.radius
    ball = 4 / 3 * math.pi * r**3
    if isinstance(solid, Capsule):
        return math.pi * r * r * solid.length + ball
    a, b, c = solid.core
    # Steiner's formula for parallel bodies: V + S r + M r² + 4/3 π r³ of the core
    faces, edges = 8 * r * (a * b + b * c + c * a), 2 * math.pi * r * r * (a + b + c)
    return 8 * a * b * c + faces + edges + ball


def inertia(solid: Capsule | RoundedBox, mass: float) -> Tensor:
    """Return the inertia of the homogeneous solid about its centre."""
    if isinstance(solid, Capsule):
        return _inertia_of_capsule(solid, mass)
    density = mass / volume(solid)
    x, y, z = solid.core
    s_x = density * _second_moment(x, y, z, solid.radius)
    s_y = density * _second_moment(y, z, x, solid.radius)
    s_z = density * _second_moment(z, x, y, solid.radius)
    return (s_y + s_z, 0.0, 0.0, s_z + s_x, 0.0, s_x + s_y)


def _inertia_of_capsule(capsule: Capsule, mass: float) -> Tensor:
    length, r = capsule.length, capsule.radius
    density = mass / volume(capsule)
    middle, ends = density * math.pi * r * r * length, density * 4 / 3 * math.pi * r**3
    along = middle * r * r / 2 + ends * 2 / 5 * r * r
    # the centre of a half ball is 3/8 r beyond its flat face; both about the middle (Steiner)
    across = middle * (length**2 / 12 + r * r / 4)
    across += ends * (2 / 5 * r * r + length**2 / 4 + 3 / 8 * length * r)
    return (across, 0.0, 0.0, across, 0.0, along)


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
