"""Sliding friction that points against the slip: what the engine's friction lacks, pair by pair.

By Coulomb's law a point that slides with the velocity v feels the friction -F v / |v|, where F is
the coefficient times the normal force. The engine solves the two fixed tangents t of a point in
turns, each with its own step 1 / D_t, D_t = t · J M^-1 J^T t, and scales the pair to F. It
converges to a force parallel to (v_1 / D_1, v_2 / D_2) instead. The two agree if the point slides
along a tangent or is equally mobile along both. Otherwise a body turns aside, at any step and with
any number of iterations.

The missing part, the friction by the law minus that of the engine, is known after a step and
applied in the next. It depends on the direction of a velocity and is explicit, so a step takes up
only a share of it, |v| / (2 h F D), lest slow and light points shake. While a point slides on, the
shares add up to all of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

Triple = Sequence[float]

MIN_SHARE = 1e-3  # points so slow that a step may take up less only shake, and slide nowhere
MAX_GAIN = 0.5  # of the gain at which the direction of slip would swing from step to step
NEGLIGIBLE = 3e-3  # share of the friction that may be missing


class LinkMotion(NamedTuple):
    """A link in the world: its centre of mass, velocity and angular velocity."""

    centre: Triple
    velocity: Triple
    spin: Triple


class SlidingLink(NamedTuple):
    """A link, one over its mass and one over its least moment of inertia.

    They bound its mobility from above: a link of a chain yields less than by itself.
    """

    moving: LinkMotion
    per_mass: float
    per_inertia: float


class Point(NamedTuple):
    """A contact point at its limit of friction, in the world.

    `place` is on the first link, and `normal` points to it. `tangents` are the directions of
    friction, `frictions` the forces along them on the first link.
    """

    place: Triple
    normal: Triple
    tangents: tuple[Triple, Triple]
    frictions: tuple[float, float]


@dataclass(frozen=True, slots=True)
class MissingFriction:
    """The friction that is missing between two links: a force on the first, and its torque.

    The torque is about `point`, the mean of the sliding points. A step may take up `share` of it.
    """

    point: tuple[float, float, float]
    force: tuple[float, float, float]
    torque: tuple[float, float, float]
    share: float
    is_negligible: bool

    def after(self, before: MissingFriction | None) -> MissingFriction:
        """Return the friction to apply, after `before` was applied in the last step."""
        if self.share == 1.0:
            return self
        first = before or MissingFriction(self.point, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0, True)
        force = _interpolated(first.force, self.force, self.share)
        torque = _interpolated(first.torque, self.torque, self.share)
        return MissingFriction(self.point, force, torque, self.share, self.is_negligible)


def missing_friction(
    first: SlidingLink, second: SlidingLink, points: Sequence[Point], time_step: float
) -> MissingFriction | None:
    """Return the missing friction of sliding points; None if one is too slow."""
    found: list[tuple[float, float, float]] = []
    whole, lacking, slowest, mobility = 0.0, 0.0, math.inf, 0.0
    for place, (nx, ny, nz), ((ax, ay, az), (bx, by, bz)), (a, b) in points:
        ux, uy, uz, own = _motion_at(first, place)
        vx, vy, vz, other = _motion_at(second, place)
        ux, uy, uz = ux - vx, uy - vy, uz - vz
        along = ux * nx + uy * ny + uz * nz
        ux, uy, uz = ux - along * nx, uy - along * ny, uz - along * nz
        speed = math.sqrt(ux * ux + uy * uy + uz * uz)
        if speed == 0:
            return None
        size = math.sqrt(a * a + b * b)
        per = -size / speed
        x, y, z = per * ux - a * ax - b * bx, per * uy - a * ay - b * by, per * uz - a * az - b * bz
        found.append((x, y, z))
        whole += size
        lacking += math.sqrt(x * x + y * y + z * z)
        slowest = min(slowest, speed)
        mobility = max(mobility, own + other)
    change = time_step * whole * mobility
    share = 1.0 if MAX_GAIN * slowest >= change else MAX_GAIN * slowest / change
    if share < MIN_SHARE:
        return None
    return _summed(points, found, share, lacking < NEGLIGIBLE * whole)


def _interpolated(
    before: tuple[float, float, float], now: tuple[float, float, float], share: float
) -> tuple[float, float, float]:
    (x, y, z), (a, b, c) = before, now
    return (x + share * (a - x), y + share * (b - y), z + share * (c - z))


def _motion_at(link: SlidingLink, place: Triple) -> tuple[float, float, float, float]:
    """Return the velocity of a link at a place, and an upper bound on its mobility there."""
    (cx, cy, cz), (vx, vy, vz), (wx, wy, wz) = link.moving
    x, y, z = place
    x, y, z = x - cx, y - cy, z - cz
    mobility_here = link.per_mass + (x * x + y * y + z * z) * link.per_inertia
    return vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x, mobility_here


def _summed(
    points: Sequence[Point],
    forces: Sequence[tuple[float, float, float]],
    share: float,
    is_negligible: bool,
) -> MissingFriction:
    if len(points) == 1:
        x, y, z = points[0].place
        return MissingFriction((x, y, z), forces[0], (0.0, 0.0, 0.0), share, is_negligible)
    px = py = pz = 0.0
    for (x, y, z), _, _, _ in points:
        px, py, pz = px + x, py + y, pz + z
    count = len(points)
    px, py, pz = px / count, py / count, pz / count
    fx = fy = fz = tx = ty = tz = 0.0
    for ((x, y, z), _, _, _), (ax, ay, az) in zip(points, forces, strict=True):
        x, y, z = x - px, y - py, z - pz
        fx, fy, fz = fx + ax, fy + ay, fz + az
        tx, ty, tz = tx + y * az - z * ay, ty + z * ax - x * az, tz + x * ay - y * ax
    return MissingFriction((px, py, pz), (fx, fy, fz), (tx, ty, tz), share, is_negligible)
