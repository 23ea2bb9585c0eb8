"""Check a link of a definition, mainly its declared inertia."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Tensor
from somo_cli.manipulator.read import link_from
from somo_cli.problems import Pointer, Problem

IsSound: TypeAlias = Callable[[Pointer], bool]
"""Returns whether the schema found no error at a pointer or below it."""

INERTIA_FACTOR = 10.0
"""Warn if a declared inertia is larger than that of the solid by more than this factor."""


def link_problems(document: Document, at: Pointer, is_sound: IsSound) -> Iterator[Problem]:
    """Yield the errors and warnings about the link at a pointer."""
    data = document.at(at)
    if not is_sound(at) or not isinstance(data, Mapping):
        return
    if data["shape_type"] in ("cylinder", "capsule") and len(data["dimensions"]) == 3:
        yield Problem(
            document.span((*at, "dimensions", 2)),
            f"a {data['shape_type']} has [height, radius]; the third value is ignored",
            severity="warning",
        )
    if data.get("inertial_values") is not None:
        yield from _inertia_problems(document, at, data)


def _inertia_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    link = link_from(data)
    assert link.inertia is not None
    place = document.span((*at, "inertial_values"))
    own = link.solid.inertia(link.mass)
    shown = ", ".join(f"{moment:.3g}" for moment in geometry.principal_moments(own))
    hint = f"leave inertial_values out; the solid's own is [{shown}]"
    if why := _impossibility(link.inertia):
        message = f"no body can have this inertia: {why}"
        yield Problem(place, message, hint, "warning", "impossible-inertia")
        return
    ratio = geometry.farthest_moment_ratio(link.inertia, own)
    if not 1 / INERTIA_FACTOR <= ratio <= INERTIA_FACTOR:
        message = (
            f"the declared inertia is {ratio:.3g} times that of a homogeneous "
            f"{data['shape_type']} of this size and mass"
        )
        yield Problem(place, message, hint, "warning", "declared-inertia")


def _impossibility(inertia: Tensor) -> str:
    """Return why no body can have an inertia, empty if one can; rounding is accepted."""
    a, b, c = geometry.principal_moments(inertia)
    if a <= 0:
        return f"a principal moment is {a:.3g}"
    if a + b < c - 1e-9 * abs(c):
        return f"its principal moments {a:.3g} and {b:.3g} add up to less than the third, {c:.3g}"
    return ""
