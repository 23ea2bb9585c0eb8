"""The rotation of a rigid body to second order: the rate at which an engine should turn it.

Bullet adds the gyroscopic torque as it is at the start of a step, ω' = ω + h I⁻¹ (τ - ω x I ω),
and then turns the body by h ω'. This adds energy to every body whose moments differ, in each second
h G I G with G = I⁻¹ (ω x I ω), and without end. With velocities at half steps, Π the angular
momentum at a whole one, and exp(v) the rotation by the vector v, the rate of the coming step is the
X for which the momentum in space stays what it is,

    I X = exp(-h X / 2) Π,

and a step later, after what contacts changed X to ω, Π' = exp(-h ω) (Π + I (ω - X)). This is the
midpoint rule on the group of rotations: it keeps the angular momentum exactly, is reversible and of
order two, so its energy swings and does not grow. The engine comes to X under the torque

    τ = I (X - ω) / h + ω x I ω.

Simo and Wong, Int. J. Numer. Methods Eng. 31 (1991) 19 (the rule and that it keeps Π); Krysl and
Endres, Int. J. Numer. Methods Eng. 62 (2005) 2154 (reversible, order two); Hairer, Lubich, Wanner,
Geometric Numerical Integration, ch. VII.5.

Vectors lie along the principal axes of the body; moments hold one number for each of them.
"""

from __future__ import annotations

import math

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector

MAX_EXACT_ANGLE = math.pi / 4
"""Seen in Bullet 3.25: up to this angle h ω [rad] a body turns by it in a step; beyond, by
2 atan(h ω tan(MAX_EXACT_ANGLE / 2) / MAX_EXACT_ANGLE), which is less."""

_SLOPE = math.tan(MAX_EXACT_ANGLE / 2) / MAX_EXACT_ANGLE
_TOLERANCE = 1e-12  # residual of a solution, relative to the momentum
_MAX_ITERATIONS = 30  # 4 are enough for steps up to 0.3 rad, 9 for 1 rad
_MIN_ANGLE = 1e-9  # rad: half of it turns a vector by less than its rounding matters


def half_turned(vector: Vector, rate: Vector, time_step: float) -> Vector:
    """Return exp(-h ω / 2) v: a vector in axes that turn by half of a step at `rate`.

    With a negative time step they turn back.
    """
    vx, vy, vz = vector
    wx, wy, wz = rate
    size = math.sqrt(wx * wx + wy * wy + wz * wz)
    angle = size * abs(time_step)
    if angle < _MIN_ANGLE:
        return vector
    half = 0.5 * angle if angle <= MAX_EXACT_ANGLE else math.atan(angle * _SLOPE)
    sine, versine = math.sin(half) / size, 2 * (math.sin(0.5 * half) / size) ** 2
    if time_step < 0:
        sine = -sine
    # Rodrigues: v - sin ω x v + (1 - cos) ω x (ω x v), here with an ω of any length
    cx, cy, cz = wy * vz - wz * vy, wz * vx - wx * vz, wx * vy - wy * vx
    return (
        vx - sine * cx + versine * (wy * cz - wz * cy),
        vy - sine * cy + versine * (wz * cx - wx * cz),
        vz - sine * cz + versine * (wx * cy - wy * cx),
    )


def midpoint_rate(
    moments: Vector, momentum: Vector, guess: Vector, time_step: float
) -> Vector | None:
    """Return the X [rad/s] for which I X = exp(-h X / 2) Π, by Newton's method from a guess.

    With a negative time step that is the rate of the step before. None if it does not converge.
    """
    a, b, c = moments
    x, y, z = guess
    px, py, pz = momentum
    tolerance = _TOLERANCE * (abs(px) + abs(py) + abs(pz))
    half = 0.5 * time_step
    for _ in range(_MAX_ITERATIONS):
        lx, ly, lz = half_turned(momentum, (x, y, z), time_step)
        rx, ry, rz = lx - a * x, ly - b * y, lz - c * z
        if abs(rx) + abs(ry) + abs(rz) <= tolerance:
            return x, y, z
        # l = exp(-v) Π with v = h X / 2 changes by l x (J dv), of which J = 1 - [v] / 2 + [v]² / 6
        # but for what is of third order in v; so (I - h/2 [l] J) dX = r, solved by Cramer's rule
        vx, vy, vz = half * x, half * y, half * z
        cx, cy, cz = (ly * vz - lz * vy) / 6, (lz * vx - lx * vz) / 6, (lx * vy - ly * vx) / 6
        straight = 0.5 * (lx * vx + ly * vy + lz * vz)
        across = 1 - (vx * vx + vy * vy + vz * vz) / 6
        ux, uy, uz = across * lx, across * ly, across * lz
        hx, hy, hz = 0.5 * lx, 0.5 * ly, 0.5 * lz
        xx = a - half * (straight - hx * vx + cx * vx)
        yy = b - half * (straight - hy * vy + cy * vy)
        zz = c - half * (straight - hz * vz + cz * vz)
        xy = half * (uz + hy * vx - cx * vy)
        yx = half * (-uz + hx * vy - cy * vx)
        xz = half * (-uy + hz * vx - cx * vz)
        zx = half * (uy + hx * vz - cz * vx)
        yz = half * (ux + hz * vy - cy * vz)
        zy = half * (-ux + hy * vz - cz * vy)
        px, py, pz = yy * zz - yz * zy, yz * zx - yx * zz, yx * zy - yy * zx
        determinant = xx * px + xy * py + xz * pz
        if determinant == 0:
            return None
        x += (px * rx + (xz * zy - xy * zz) * ry + (xy * yz - xz * yy) * rz) / determinant
        y += (py * rx + (xx * zz - xz * zx) * ry + (xz * yx - xx * yz) * rz) / determinant
        z += (pz * rx + (xy * zx - xx * zy) * ry + (xx * yy - xy * yx) * rz) / determinant
    return None


def gyroscopic_acceleration(moments: Vector, rate: Vector) -> Vector:
    """Return G = I⁻¹ (ω x I ω) [rad/s²]."""
    a, b, c = moments
    x, y, z = rate
    return (c - b) / a * y * z, (a - c) / b * z * x, (b - a) / c * x * y


def rate_half_step_before(
    moments: Vector, rate: Vector, next_rate: Vector, time_step: float
) -> Vector:
    """Return the rate [rad/s] half a step before a start at `rate`, from the engine's first step.

    That step led to `next_rate` with an explicit gyroscopic torque. The rest of the change is due
    to the torque of contacts.
    """
    gyroscopic = gyroscopic_acceleration(moments, rate)
    change = [
        after - before + time_step * own
        for before, after, own in zip(rate, next_rate, gyroscopic, strict=True)
    ]
    a, b, c = (
        moment * (before - 0.5 * by)
        for moment, before, by in zip(moments, rate, change, strict=True)
    )
    return midpoint_rate(moments, (a, b, c), rate, -time_step) or rate


def mean_rates(
    moments: Vector, rotations: Array, before: Array, after: Array, time_step: float
) -> Array:
    """Return angular velocities in the world, shape (rows, 3), from those half a step either side.

    They are those of the mean momenta: the mean of the velocities would be too small by
    (h ω)² / 8. `rotations`, shape (rows, 3, 3), turn principal axes to the world.
    """
    own = (np.einsum("nji,nj->ni", rotations, one) for one in (before, after))
    momenta = [
        _half_turned_rows(one * np.array(moments), one, step)
        for one, step in zip(own, (time_step, -time_step), strict=True)
    ]
    means: Array = 0.5 * (momenta[0] + momenta[1]) / moments
    rates: Array = np.einsum("nij,nj->ni", rotations, means)
    return rates


def _half_turned_rows(vectors: Array, rates: Array, time_step: float) -> Array:
    """Return `half_turned` of many vectors at once, shape (rows, 3)."""
    turned = [
        half_turned(vector, rate, time_step)
        for vector, rate in zip(vectors.tolist(), rates.tolist(), strict=True)
    ]
    return np.array(turned).reshape(-1, 3)
