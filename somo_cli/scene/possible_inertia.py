"""Whether a body can have an inertia, and the nearest one that it can have.

No principal moment is more than the sum of the other two: with the second moments s of the mass
along the principal axes, moments are s2 + s3, s1 + s3 and s1 + s2, and no s is below 0.
"""

from __future__ import annotations

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Tensor, Vector
from somo_cli.scene.compound import principal_axes

ROUNDING = 0.005
"""Of the sum of the moments: what three digits leave open. Each is wrong by half a unit of the
third digit at most, which is 0.5 % of it."""


def impossibility(inertia: Tensor) -> str:
    """Return why no body has an inertia [kg·m²], with the numbers; empty if one has.

    What three digits may have rounded away is none, and a moment of 0, as of a point, neither.
    """
    a, b, c = geometry.principal_moments(inertia)
    if a < -ROUNDING * abs(c):
        return f"a principal moment is {a:.3g} kg·m²"
    if c - a - b > ROUNDING * (a + b + c):
        found = f"its principal moments {a:.3g} and {b:.3g} kg·m² add up to less than the third"
        return f"{found}, {c:.3g}"
    return ""


def is_rounded(inertia: Tensor) -> bool:
    """Whether the largest principal moment is more than the sum of the others, by any amount."""
    a, b, c = geometry.principal_moments(inertia)
    return c - a - b > 1e-12 * c


def nearest_possible(inertia: Tensor) -> Tensor:
    """Return the inertia, or the nearest one that a body has, with second moments of 0 or more."""
    if not is_rounded(inertia):
        return inertia
    axes, moments = principal_axes(inertia)
    half = sum(moments) / 2
    s1, s2, s3 = (max(half - moment, 0.0) for moment in moments)
    return geometry.rotated_tensor((s2 + s3, 0.0, 0.0, s1 + s3, 0.0, s1 + s2), axes)


def described(inertia: Tensor) -> str:
    """Return the principal moments in words, such as "[1, 2, 2.5] kg·m²"."""
    moments: Vector = geometry.principal_moments(inertia)
    return "[" + ", ".join(f"{moment:.3g}" for moment in moments) + "] kg·m²"
