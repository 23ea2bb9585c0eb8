"""Check whether a body can have an inertia, and compute the nearest possible one.

No principal moment of inertia exceeds the sum of the other two. With the second moments s of the
mass along the principal axes, the moments of inertia are s2 + s3, s1 + s3 and s1 + s2, and no s is
negative.
"""

from __future__ import annotations

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Tensor, Vector
from somo_cli.scene.compound import principal_axes

ROUNDING = 0.005
"""The rounding error of moments given with three digits, divided by their sum. Each is wrong by at
most half a unit of its third digit, which is 0.5 % of it."""


def impossibility(inertia: Tensor) -> str:
    """Return why no body can have an inertia [kg·m²], with numbers; empty if one can.

    Rounding to three digits is accepted, and so is a moment of 0, which a point mass has.
    """
    a, b, c = geometry.principal_moments(inertia)
    if a < -ROUNDING * abs(c):
        return f"a principal moment is {a:.3g} kg·m²"
    if c - a - b > ROUNDING * (a + b + c):
        found = f"its principal moments {a:.3g} and {b:.3g} kg·m² add up to less than the third"
        return f"{found}, {c:.3g}"
    return ""


def is_rounded(inertia: Tensor) -> bool:
    """Return whether the largest principal moment exceeds the sum of the others at all."""
    a, b, c = geometry.principal_moments(inertia)
    return c - a - b > 1e-12 * c


def nearest_possible(inertia: Tensor) -> Tensor:
    """Return the inertia [kg·m²], with negative second moments of the mass set to 0."""
    if not is_rounded(inertia):
        return inertia
    axes, moments = principal_axes(inertia)
    half = sum(moments) / 2
    s1, s2, s3 = (max(half - moment, 0.0) for moment in moments)
    return geometry.rotated_tensor((s2 + s3, 0.0, 0.0, s1 + s3, 0.0, s1 + s2), axes)


def described(inertia: Tensor, digits: int = 3) -> str:
    """Return the principal moments as text, such as "[1, 2, 2.5] kg·m²"."""
    moments: Vector = geometry.principal_moments(inertia)
    return "[" + ", ".join(f"{moment:.{digits}g}" for moment in moments) + "] kg·m²"
