"""Cross-sections of a beam along z: area, second moments, torsion constant.

Every shape is a rectangle of half widths p and q swept by a disc of radius r: a box has r = 0, a
disc p = q = 0, a stadium p = 0 or q = 0. So one formula covers all shapes, and a comparison of
support functions, h(θ) = p |cos θ| + q |sin θ| + r, shows whether a shape lies inside another
(Schneider, Convex Bodies, 2nd ed. 2014, sec. 1.7).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

SMALLEST = 1e-9
LARGEST = 1e3
"""Limits of the sizes of a shape [m]: others are typing errors, and would over- or underflow."""

_ODD_FIFTH_POWERS = 31 / 32 * 1.0369277551433699  # Σ 1/n⁵ over odd n: 31/32 ζ(5)


@dataclass(frozen=True, slots=True)
class Section:
    """A shape with its centroid at the origin, symmetric about x and y, with a bore or without.

    `core` holds the half widths p along x and q along y [m], `rounding` the radius r [m]; `text` is
    the shape as the user wrote it.
    """

    text: str
    core: tuple[float, float]
    rounding: float
    bore: Section | None = None

    def __str__(self) -> str:
        return self.text if self.bore is None else f"{self.text} with a bore of {self.bore}"

    @property
    def area(self) -> float:
        """The area of the material [m²]."""
        (p, q), r = self.core, self.rounding
        solid = 4 * p * q + 4 * (p + q) * r + math.pi * r**2
        return solid if self.bore is None else solid - self.bore.area

    def without(self, bore: Section) -> Section:
        """Return this section with a concentric void; raise ValueError unless it fits inside."""
        if self.bore is not None:
            raise ValueError(f"'{self.text}' has a bore already: '{self.bore}'")
        if bore.bore is not None:
            raise ValueError(f"the bore '{bore}' has a bore itself: give a shape without one")
        if not _margin(self, bore) > 0:
            raise ValueError(f"the bore '{bore}' does not fit inside '{self}'")
        return replace(self, bore=bore)

    def second_moment(self, axis: tuple[float, float]) -> float:
        """Return I = ∫ (distance from the axis)² dA [m⁴], for bending about a direction (x, y).

        x and y are principal axes, so I = Ix ax² + Iy ay² for a unit axis (Timoshenko, Strength of
        Materials I, 3rd ed. 1955, appendix A). The axis need not be a unit vector. Raises
        ValueError if it is zero or not finite.
        """
        length = math.hypot(*axis)
        if not 0 < length < math.inf:
            raise ValueError(f"the bending axis {axis} has no direction")
        about_x, about_y = self._principal()
        return about_x * (axis[0] / length) ** 2 + about_y * (axis[1] / length) ** 2

    def _principal(self) -> tuple[float, float]:
        """Return Ix = ∫ y² dA and Iy = ∫ x² dA [m⁴]."""
        (p, q), r = self.core, self.rounding
        about_x, about_y = _about_first(p, q, r), _about_first(q, p, r)
        if self.bore is None:
            return about_x, about_y
        void_x, void_y = self.bore._principal()
        return about_x - void_x, about_y - void_y

    def torsion_constant(self) -> float:
        """Return J [m⁴] of Saint-Venant, so that a torque twists by torque / (G J) per metre.

        Known for a disc, a box and a ring (Timoshenko and Goodier, Theory of Elasticity, 3rd ed.
        1970, sec. 104 and 109); raises ValueError for any other section.
        """
        if self._is_round and (self.bore is None or self.bore._is_round):
            inner = 0.0 if self.bore is None else self.bore.rounding
            return math.pi / 2 * (self.rounding**4 - inner**4)
        if self.rounding == 0 and self.bore is None:
            return _torsion_of_box(2 * max(self.core), 2 * min(self.core))
        raise ValueError(
            f"there is no closed form for the torsion of '{self}'; give the rigidity instead"
        )

    @property
    def _is_round(self) -> bool:
        return self.core == (0.0, 0.0)


def _about_first(p: float, q: float, r: float) -> float:
    """Return ∫ y² dA of a solid shape [m⁴], p along x.

    It is the sum over a bar of height 2 (q + r) in the middle, two of height 2 q at its sides, and
    four quarters of a disc with centres at ±q, by the parallel axis theorem.
    """
    bars = 4 / 3 * (p * (q + r) ** 3 + r * q**3)
    return bars + math.pi * r**2 * q**2 + 8 / 3 * q * r**3 + math.pi / 4 * r**4


def _torsion_of_box(a: float, b: float) -> float:
    """Return J [m⁴] of a rectangle a by b, a >= b (Timoshenko and Goodier, sec. 109).

    J = a b³/3 (1 - 192 b/(π⁵ a) Σ tanh(n π a/2b)/n⁵) over odd n. With tanh x = 1 - 2/(1 + e^2x) the
    slowly converging part of the series is a constant, and six terms of the rest are enough.
    """
    total = _ODD_FIFTH_POWERS
    for n in (1, 3, 5, 7, 9, 11):
        small = math.exp(-n * math.pi * a / b)
        total -= 2 * small / (1 + small) / n**5
    return a * b**3 / 3 * (1 - 192 * b / (math.pi**5 * a) * total)


def _margin(outer: Section, inner: Section) -> float:
    """Return the least distance between the support functions of two shapes [m]."""
    p = outer.core[0] - inner.core[0]
    q = outer.core[1] - inner.core[1]
    # minimum of p cos θ + q sin θ for θ from 0 to π/2: at an end, unless p and q are negative
    least = -math.hypot(p, q) if p < 0 and q < 0 else min(p, q)
    return least + outer.rounding - inner.rounding


_Shape: TypeAlias = tuple[tuple[float, float], float]


def _box(x: float, y: float) -> _Shape:
    return (x / 2, y / 2), 0.0


def _disc(radius: float) -> _Shape:
    return (0.0, 0.0), radius


def _stadium(x: float, y: float) -> _Shape:
    radius = min(x, y) / 2
    return (x / 2 - radius, y / 2 - radius), radius


_SHAPES: Mapping[str, tuple[str, int, Callable[..., _Shape]]] = {
    "box": ("box:X,Y", 2, _box),
    "disc": ("disc:R", 1, _disc),
    "stadium": ("stadium:X,Y", 2, _stadium),
}


def parse_section(text: str) -> Section:
    """Return the section of `box:X,Y`, `disc:R` or `stadium:X,Y`, all in metres.

    X and Y are the full widths along x and y. A stadium is a rectangle with a half disc at each end
    of its longer side, X by Y overall. Raises ValueError for any other text.
    """
    name, _, rest = text.partition(":")
    if name.strip() not in _SHAPES:
        forms = [form for form, _, _ in _SHAPES.values()]
        known = f"{', '.join(forms[:-1])} or {forms[-1]}"
        raise ValueError(f"'{text}' is not a known shape: use {known} in metres")
    form, count, make = _SHAPES[name.strip()]
    words = [word.strip() for word in rest.split(",")] if rest.strip() else []
    if len(words) != count:
        needs = "two numbers" if count == 2 else "one number"
        raise ValueError(f"'{text}' needs {needs}: {form} in metres")
    core, rounding = make(*(_size(word, text, form) for word in words))
    return Section(text, core, rounding)


def _size(word: str, text: str, form: str) -> float:
    try:
        size = float(word)
    except ValueError:
        size = math.nan
    if math.isnan(size):
        raise ValueError(f"'{word}' in '{text}' is not a number: {form} in metres")
    if size <= 0:
        raise ValueError(f"{word} in '{text}' is not positive: {form} in metres")
    if not SMALLEST <= size <= LARGEST:
        raise ValueError(
            f"{word} in '{text}' is not from {SMALLEST:g} to {LARGEST:g}: {form} in metres"
        )
    return size
