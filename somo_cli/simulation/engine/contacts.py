"""Contact points as the engine reports them, and the sums of their forces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector

LinkIndex: TypeAlias = tuple[int, int]
"""A body and one of its links. Bodies are counted in the order of the plan, then objects, then
the ground; links as in the chain, 0 the base."""

BodyPair: TypeAlias = tuple[int, int]
"""Two bodies as a `LinkIndex` counts them, the lower number first."""


class ContactPoint(NamedTuple):
    """One contact point in the last step, in engine units and the world's axes.

    `normal` is a unit vector from second to first, `normal_force` the force along it on the first.
    `friction_forces` are the two friction forces on the first, each a direction and a magnitude.
    """

    first: LinkIndex
    second: LinkIndex
    point: Vector
    normal: Vector
    normal_force: float
    friction_forces: tuple[tuple[Vector, float], tuple[Vector, float]]


def friction_contact(
    first: LinkIndex, second: LinkIndex, point: Sequence[float], force: Sequence[float]
) -> ContactPoint:
    """Return a contact point with friction alone; another point has the normal force."""
    size = geometry.norm(geometry.vector(force))
    x, y, z = (part / size if size > 0 else 0.0 for part in force)
    friction_forces = ((x, y, z), size), (geometry.ZERO, 0.0)
    return ContactPoint(first, second, geometry.vector(point), geometry.ZERO, 0.0, friction_forces)


class ContactForce(NamedTuple):
    """The sum of contact forces on one body, link or object, in the world's axes [engine units].

    `fx`, `fy`, `fz` are the total force; `normal` and `friction` the sums of the magnitudes of
    normal and friction forces; `friction_x`, `friction_y`, `friction_z` the total friction.
    """

    fx: float
    fy: float
    fz: float
    normal: float
    friction: float
    friction_x: float
    friction_y: float
    friction_z: float


NO_CONTACT = ContactForce(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

SignedContact: TypeAlias = tuple[ContactPoint, float]
"""A contact point, and the sign of its forces: 1 on its first link, -1 on its second."""


def contacts_on(points: Sequence[ContactPoint], body: int) -> list[SignedContact]:
    """Return the contact points of a body with others; forces within the body sum to zero."""
    return [
        (point, 1.0 if point.first[0] == body else -1.0)
        for point in points
        if (point.first[0] == body) != (point.second[0] == body)
    ]


def contacts_between(points: Sequence[ContactPoint], body: int, other: int) -> list[SignedContact]:
    """Return the contact points between two bodies."""
    return [
        contact
        for contact in contacts_on(points, body)
        if other in (contact[0].first[0], contact[0].second[0])
    ]


def contacts_on_link(points: Sequence[ContactPoint], link: LinkIndex) -> list[SignedContact]:
    """Return the contact points of a link, including those with other links of its body."""
    return [
        (point, sign)
        for point in points
        for sign, one in ((1.0, point.first), (-1.0, point.second))
        if one == link
    ]


def total_force(contacts: Sequence[SignedContact]) -> tuple[float, float, float, float]:
    """Return the total force (x, y, z) in the world's axes, then the sum of normal forces."""
    x = y = z = normal_force = 0.0
    for point, sign in contacts:
        normal_force += point.normal_force
        for (dx, dy, dz), size in ((point.normal, point.normal_force), *point.friction_forces):
            force = sign * size
            x, y, z = x + force * dx, y + force * dy, z + force * dz
    return x, y, z, normal_force


def contact_force(contacts: Sequence[SignedContact]) -> ContactForce:
    """Return the sum of contact forces, with friction reported separately as well."""
    if not contacts:
        return NO_CONTACT
    tx = ty = tz = friction = 0.0
    for point, sign in contacts:
        x = y = z = 0.0
        for (dx, dy, dz), size in point.friction_forces:
            force = sign * size
            x, y, z = x + force * dx, y + force * dy, z + force * dz
        tx, ty, tz, friction = tx + x, ty + y, tz + z, friction + math.hypot(x, y, z)
    fx, fy, fz, normal_force = total_force(contacts)
    return ContactForce(fx, fy, fz, normal_force, friction, tx, ty, tz)
