"""Straight-line code on plain floats, written once for a chain: sums of products, zeros left out.

Ten joints are too few for arrays: a call into numpy costs as much as forty products of floats.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

from somo_cli.manipulator.geometry import Matrix, Vector

Term: TypeAlias = tuple[float, tuple[str, ...]]
"""A coefficient and the names of the factors of a product."""
Names: TypeAlias = tuple[str, str, str]
"""The names of the parts of a vector; an empty one is zero."""

ZERO_NAMES: Names = ("", "", "")


class StraightCode:
    """Collects the assignments of a function."""

    def __init__(self) -> None:
        self._lines: list[str] = []

    def add(self, line: str) -> None:
        """Add a line."""
        self._lines.append(line)

    def total(self, terms: Iterable[Term]) -> str:
        """Add a sum of products; return its name, empty if it is zero."""
        kept = [(k, names) for k, names in terms if k != 0 and all(names)]
        if not kept:
            return ""
        if len(kept) == 1 and kept[0][0] == 1 and len(kept[0][1]) == 1:
            return kept[0][1][0]
        name = f"v{len(self._lines)}"
        text = ""
        for coefficient, names in kept:
            sign = "-" if coefficient < 0 else "+" if text else ""
            text += f" {sign} {_product(abs(coefficient), names)}"
        self.add(f"{name} = {text.strip()}")
        return name

    def dot(self, constant: Vector, vector: Names) -> str:
        """Add the product of a constant vector and another; return its name, empty for zero."""
        return self.total((one, (name,)) for one, name in zip(constant, vector, strict=True))

    def turned(self, vector: Names, axis: Vector, cosine: str, sine: str, sign: int) -> Names:
        """Add a vector turned about an axis, by an angle or for a `sign` of -1 back.

        v cos q + (a x v) sin q + a (a · v) (1 - cos q): Rodrigues.
        """
        if vector == ZERO_NAMES:
            return ZERO_NAMES
        along = ""
        is_oblique = sum(one != 0 for one in axis) > 1
        if is_oblique:
            dot = self.dot(axis, vector)
            along = self.total([(1, (dot,)), (-1, (cosine, dot))])
        found = []
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            if not is_oblique and axis[i] != 0:
                found.append(vector[i])
                continue
            cross = [(sign * axis[j], (sine, vector[k])), (-sign * axis[k], (sine, vector[j]))]
            found.append(self.total([(1, (cosine, vector[i])), *cross, (axis[i], (along,))]))
        return (found[0], found[1], found[2])

    def rotated(self, matrix: Matrix, vector: Names) -> Names:
        """Add a constant matrix times a vector."""
        x, y, z = (self.dot(row, vector) for row in matrix)
        return (x, y, z)

    def plus(self, *vectors: Names) -> Names:
        """Add the sum of vectors."""
        x, y, z = (self.total((1, (one[i],)) for one in vectors) for i in range(3))
        return (x, y, z)

    def with_cross(self, moment: Names, arm: Vector, force: Names) -> Names:
        """Add moment + arm x force, for a constant arm."""
        found = []
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            cross = [(arm[j], (force[k],)), (-arm[k], (force[j],))]
            found.append(self.total([(1, (moment[i],)), *cross]))
        return (found[0], found[1], found[2])

    def function(self, arguments: str, results: Sequence[str]) -> Callable[..., Any]:
        """Return the function that returns these results, 0 for an empty name, as a tuple."""
        values = ", ".join(one or "0.0" for one in results)
        body = "\n    ".join([*self._lines, f"return ({values},)"])
        names: dict[str, Any] = {"sin": math.sin, "cos": math.cos}
        # of numbers and our own names only: nothing of a file gets into it as text
        exec(f"def written({arguments}):\n    {body}\n", names)
        found: Callable[..., Any] = names["written"]
        return found


def _product(size: float, names: Sequence[str]) -> str:
    """Return a product as it is written; raises ValueError for a size that is not finite."""
    if not math.isfinite(size):
        raise ValueError(f"a coefficient is {size}, but must be finite")
    return " * ".join(names if size == 1 and names else [repr(size), *names])
