"""Contact of round links: cylinders, capsules and spheres with one radius and one axis."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Link, Shape
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.manipulator.round_solids import Capsule
from somo_cli.manipulator.solids import Cylinder, Sphere

FLAT = 0.2
"""A cylinder stands on its face if the sine of the angle between axis and normal is smaller."""
ROUNDING = 1e-9
"""The largest deviation that is rounding, divided by the radius."""


@dataclass(frozen=True, slots=True)
class RoundBody:
    """A cylinder, a capsule or, without an axis, a sphere: its centre, unit axis and radius.

    Vectors are in the frame and the radius is in the length unit of the caller.
    """

    centre: Vector
    axis: Vector | None
    radius: float

    def seen_from(self, origin: Vector, axes: Matrix) -> RoundBody:
        """Return the body in another frame, whose origin and axes are given in the present one."""
        back = geometry.transposed(axes)
        axis = None if self.axis is None else geometry.rotate(back, self.axis)
        return RoundBody(
            geometry.rotate(back, geometry.subtract(self.centre, origin)), axis, self.radius
        )

    def has_in_line(self, other: RoundBody) -> bool:
        """Return whether another round body has the same radius and lies on the same axis."""
        away = geometry.subtract(other.centre, self.centre)
        if self.axis is not None:
            away = geometry.subtract(
                away, geometry.scaled(self.axis, geometry.dot(away, self.axis))
            )
        apart = abs(other.radius - self.radius) + geometry.norm(away)
        if self.axis is not None and other.axis is not None:
            apart += self.radius * (1 - abs(geometry.dot(self.axis, other.axis)))
        return apart <= ROUNDING * self.radius

    def offset_to_line(self, point: Vector, normal: Vector) -> Vector:
        """Return the vector from a contact point to the line of contact of the body's round side.

        It is zero if the body stands on its face. `point`, `normal` and the result are in the frame
        of the body's centre and axis; `normal` is a unit vector towards the body.
        """
        seen = geometry.subtract(point, self.centre)
        out, along = normal, 0.0
        if self.axis is not None:
            along = geometry.dot(seen, self.axis)
            out = geometry.subtract(
                normal, geometry.scaled(self.axis, geometry.dot(normal, self.axis))
            )
        size = geometry.norm(out)
        if size < FLAT:
            return geometry.ZERO
        foot = geometry.scaled(out, -self.radius / size)
        if self.axis is not None:
            foot = geometry.add(foot, geometry.scaled(self.axis, along))
        return geometry.subtract(foot, seen)


def round_body_of(link: Link) -> RoundBody | None:
    """Return the round body that all shapes of a link form, in the link frame, else None."""
    found = [_round_of(shape) for shape in link.shapes]
    rounds = [one for one in found if one is not None]
    if not rounds or len(rounds) < len(found):
        return None
    whole = next((one for one in rounds if one.axis is not None), rounds[0])
    return whole if all(whole.has_in_line(one) for one in rounds) else None


def _round_of(shape: Shape) -> RoundBody | None:
    if isinstance(shape.solid, Sphere):
        return RoundBody(shape.position, None, shape.solid.radius)
    if not isinstance(shape.solid, Capsule | Cylinder):
        return None
    axis = geometry.rotate(geometry.rotation_from_rpy(shape.rpy), (0.0, 0.0, 1.0))
    return RoundBody(shape.position, axis, shape.solid.radius)
