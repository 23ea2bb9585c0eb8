"""Vectors, rotations and inertia tensors in three dimensions, on plain tuples.

The compiler does without numpy, so that `somo build` starts fast.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]
Tensor: TypeAlias = tuple[float, float, float, float, float, float]
"""A symmetric matrix: xx, xy, xz, yy, yz, zz."""

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZERO: Vector = (0.0, 0.0, 0.0)


def vector(values: Iterable[float]) -> Vector:
    """Return three numbers as a vector; raise ValueError for more or fewer."""
    x, y, z = values
    return (float(x), float(y), float(z))


def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a: Vector, factor: float) -> Vector:
    """Return a times a factor."""
    return (factor * a[0], factor * a[1], factor * a[2])


def dot(a: Vector, b: Vector) -> float:
    """Return a · b."""
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    (x, y, z), (bx, by, bz) = a, b
    return (y * bz - z * by, z * bx - x * bz, x * by - y * bx)


def norm(a: Vector) -> float:
    """Return the Euclidean length of a."""
    return math.hypot(*a)


def unit(a: Vector) -> Vector:
    """Return a divided by its length, which must not be zero."""
    length = norm(a)
    return (a[0] / length, a[1] / length, a[2] / length)


def rotate(matrix: Matrix, a: Vector) -> Vector:
    """Return matrix · a."""
    x, y, z = a
    return (
        matrix[0][0] * x + matrix[0][1] * y + matrix[0][2] * z,
        matrix[1][0] * x + matrix[1][1] * y + matrix[1][2] * z,
        matrix[2][0] * x + matrix[2][1] * y + matrix[2][2] * z,
    )


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """Return a · b."""
    (a00, a01, a02), (a10, a11, a12), (a20, a21, a22) = a
    (b00, b01, b02), (b10, b11, b12), (b20, b21, b22) = b
    return (
        (
            a00 * b00 + a01 * b10 + a02 * b20,
            a00 * b01 + a01 * b11 + a02 * b21,
            a00 * b02 + a01 * b12 + a02 * b22,
        ),
        (
            a10 * b00 + a11 * b10 + a12 * b20,
            a10 * b01 + a11 * b11 + a12 * b21,
            a10 * b02 + a11 * b12 + a12 * b22,
        ),
        (
            a20 * b00 + a21 * b10 + a22 * b20,
            a20 * b01 + a21 * b11 + a22 * b21,
            a20 * b02 + a21 * b12 + a22 * b22,
        ),
    )


def transposed(r: Matrix) -> Matrix:
    """Return rᵀ, the inverse of a rotation."""
    return (
        (r[0][0], r[1][0], r[2][0]),
        (r[0][1], r[1][1], r[2][1]),
        (r[0][2], r[1][2], r[2][2]),
    )


def rotation_from_rpy(rpy: Vector) -> Matrix:
    """Return the rotation of URDF's roll, pitch, yaw [rad]: Rz(yaw) · Ry(pitch) · Rx(roll)."""
    (cr, cp, cy) = (math.cos(angle) for angle in rpy)
    (sr, sp, sy) = (math.sin(angle) for angle in rpy)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def rpy_from_rotation(r: Matrix) -> Vector:
    """Return URDF's roll, pitch, yaw [rad] of a rotation; at pitch ±π/2 the roll is zero."""
    pitch = math.atan2(-r[2][0], math.hypot(r[0][0], r[1][0]))
    if math.hypot(r[0][0], r[1][0]) < 1e-9:
        return (0.0, pitch, math.atan2(-r[0][1], r[1][1]))
    return (math.atan2(r[2][1], r[2][2]), pitch, math.atan2(r[1][0], r[0][0]))


def rotation_about(axis: Vector, angle: float) -> Matrix:
    """Return the rotation by `angle` [rad] about the unit vector `axis` (Rodrigues' formula)."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    t = 1.0 - c
    return (
        (c + t * x * x, t * x * y - s * z, t * x * z + s * y),
        (t * x * y + s * z, c + t * y * y, t * y * z - s * x),
        (t * x * z - s * y, t * y * z + s * x, c + t * z * z),
    )


def rotation_from_quaternion(xyzw: tuple[float, float, float, float]) -> Matrix:
    """Return the rotation of a unit quaternion (x, y, z, w)."""
    x, y, z, w = xyzw
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )


def quaternion_from_rotation(r: Matrix) -> tuple[float, float, float, float]:
    """Return the unit quaternion (x, y, z, w), w >= 0, of a rotation.

    The largest component is taken from the diagonal, so nothing is divided by a small number
    (Shepperd, J. Guidance and Control 1 (1978) 223).
    """
    trace = r[0][0] + r[1][1] + r[2][2]
    squares = (r[0][0], r[1][1], r[2][2], trace)
    largest = squares.index(max(squares))
    if largest == 3:
        q = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], 1 + trace]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        q = [0.0, 0.0, 0.0, r[k][j] - r[j][k]]
        q[i] = 1 + r[i][i] - r[j][j] - r[k][k]
        q[j] = r[i][j] + r[j][i]
        q[k] = r[i][k] + r[k][i]
    length = math.copysign(math.hypot(*q), q[3])
    return (q[0] / length, q[1] / length, q[2] / length, q[3] / length)


def rotated_tensor(tensor: Tensor, rotation: Matrix) -> Tensor:
    """Return rotation · tensor · rotationᵀ."""
    xx, xy, xz, yy, yz, zz = tensor
    full: Matrix = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    r = multiply(multiply(rotation, full), transposed(rotation))
    return (r[0][0], r[0][1], r[0][2], r[1][1], r[1][2], r[2][2])


def point_mass_inertia(mass: float, at: Vector) -> Tensor:
    """Return the inertia of a point mass about the origin: m (|r|² 1 - r rᵀ), Steiner's term."""
    x, y, z = at
    return (
        mass * (y * y + z * z),
        -mass * x * y,
        -mass * x * z,
        mass * (x * x + z * z),
        -mass * y * z,
        mass * (x * x + y * y),
    )


def principal_moments(tensor: Tensor) -> Vector:
    """Return the eigenvalues of a symmetric 3 x 3 tensor, smallest first.

    Closed form by Smith, Comm. ACM 4 (1961) 168.
    """
    xx, xy, xz, yy, yz, zz = tensor
    mean = (xx + yy + zz) / 3
    deviation = math.sqrt(
        ((xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2 * (xy**2 + xz**2 + yz**2)) / 6
    )
    if deviation == 0.0:
        return (mean, mean, mean)
    bxx, bxy, bxz, byy, byz, bzz = (
        (xx - mean) / deviation,
        xy / deviation,
        xz / deviation,
        (yy - mean) / deviation,
        yz / deviation,
        (zz - mean) / deviation,
    )
    half_determinant = (
        bxx * (byy * bzz - byz * byz)
        - bxy * (bxy * bzz - byz * bxz)
        + bxz * (bxy * byz - byy * bxz)
    ) / 2
    angle = math.acos(max(-1.0, min(1.0, half_determinant))) / 3
    largest = mean + 2 * deviation * math.cos(angle)
    smallest = mean + 2 * deviation * math.cos(angle + 2 * math.pi / 3)
    return (smallest, 3 * mean - largest - smallest, largest)


def farthest_moment_ratio(tensor: Tensor, other: Tensor) -> float:
    """Return the ratio farthest from 1 of the principal moments of two tensors."""
    pairs = zip(principal_moments(tensor), principal_moments(other), strict=True)
    ratios = [a / b if b > 0 else math.inf for a, b in pairs]
    return max(ratios, key=lambda ratio: max(ratio, 1 / ratio if ratio > 0 else math.inf))


def rotation_vector(rotation: Matrix) -> Vector:
    """Return axis times angle [rad], 0 to π, of a rotation."""
    x, y, z, w = quaternion_from_rotation(rotation)
    sine = math.hypot(x, y, z)
    # a sine this small equals its angle, to rounding
    factor = 2.0 if sine < 1e-8 else 2 * math.atan2(sine, w) / sine
    return (factor * x, factor * y, factor * z)
