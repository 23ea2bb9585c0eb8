"""What touches what: contact points as the engine tells them, and the forces they sum up to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector

Place: TypeAlias = tuple[int, int]
"""A body and one of its links. Bodies are counted in the order of the plan, then objects, then
the ground; links as in the chain, 0 the base."""


class Touch(NamedTuple):
    """One contact point in the last step, in engine units and the world's axes.

    `normal` is a unit vector from second to first, `pressed` the force along it on the first, and
    `rubs` are the two forces of friction on the first, each a direction and a size.
    """

    first: Place
    second: Place
    point: Vector
    normal: Vector
    pressed: float
    rubs: tuple[tuple[Vector, float], tuple[Vector, float]]


def rub(first: Place, second: Place, point: Sequence[float], force: Sequence[float]) -> Touch:
    """Return a friction by itself, whose normal force another contact point has."""
    size = geometry.norm(geometry.vector(force))
    x, y, z = (part / size if size > 0 else 0.0 for part in force)
    rubs = ((x, y, z), size), (geometry.ZERO, 0.0)
    return Touch(first, second, geometry.vector(point), geometry.ZERO, 0.0, rubs)


class Load(NamedTuple):
    """What contact points do to one side, in the world's axes.

    The whole force, the sum of the sizes of normal forces and of friction, the force of friction.
    """

    fx: float
    fy: float
    fz: float
    normal: float
    friction: float
    friction_x: float
    friction_y: float
    friction_z: float


NONE = Load(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

Side: TypeAlias = tuple[Touch, float]
"""A contact point, and 1 if it is looked at from its first, -1 if from its second."""


def on(touches: Sequence[Touch], body: int) -> list[Side]:
    """Return what touches a body from outside; forces within it are in no sum over the whole."""
    return [
        (touch, 1.0 if touch.first[0] == body else -1.0)
        for touch in touches
        if (touch.first[0] == body) != (touch.second[0] == body)
    ]


def between(touches: Sequence[Touch], body: int, other: int) -> list[Side]:
    """Return what of another body touches a body."""
    return [side for side in on(touches, body) if other in (side[0].first[0], side[0].second[0])]


def on_link(touches: Sequence[Touch], place: Place) -> list[Side]:
    """Return what touches a link of a body, other links of the same body included."""
    return [
        (touch, sign)
        for touch in touches
        for sign, one in ((1.0, touch.first), (-1.0, touch.second))
        if one == place
    ]


def total(sides: Sequence[Side]) -> tuple[float, float, float, float]:
    """Return the force of contact points, in the world's axes, and the sum of normal forces."""
    x = y = z = pressed = 0.0
    for touch, sign in sides:
        pressed += touch.pressed
        for (dx, dy, dz), size in ((touch.normal, touch.pressed), *touch.rubs):
            force = sign * size
            x, y, z = x + force * dx, y + force * dy, z + force * dz
    return x, y, z, pressed


def load(sides: Sequence[Side]) -> Load:
    """Return the force of contact points, and what of it is friction."""
    if not sides:
        return NONE
    tx = ty = tz = rubbed = 0.0
    for touch, sign in sides:
        x = y = z = 0.0
        for (dx, dy, dz), size in touch.rubs:
            force = sign * size
            x, y, z = x + force * dx, y + force * dy, z + force * dz
        tx, ty, tz, rubbed = tx + x, ty + y, tz + z, rubbed + math.hypot(x, y, z)
    fx, fy, fz, pressed = total(sides)
    return Load(fx, fy, fz, pressed, rubbed, tx, ty, tz)
