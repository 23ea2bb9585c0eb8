"""Faults of the shape and the mass of an object: what a schema cannot say of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem

_COUNTS = {"box": 3, "cylinder": 2, "sphere": 1, "capsule": 2}
_FORMS = {
    "box": "[x, y, z]",
    "cylinder": "[height, radius]",
    "sphere": "[radius]",
    "capsule": "[height, radius]",
}
_SHAPES_OF = {
    "dimensions": tuple(_COUNTS),
    "edge_radius": ("box",),
}
"""Each key that says a shape, and the shapes that it is for."""


def faults(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield the faults of shape and mass of the object `data` at `at`."""
    misplaced = list(_keys_of_other_shapes(document, at, data))
    yield from misplaced
    yield from _mass_faults(document, at, data)
    if not misplaced:
        yield from _faults_of_dimensions(document, at, data)


def is_free(data: Mapping[str, Any]) -> bool:
    """Whether forces move the object, so that its mass counts."""
    return not data.get("fixed", False)


def _keys_of_other_shapes(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    shape = data["shape_type"]
    for key, shapes in _SHAPES_OF.items():
        if key in data and shape not in shapes:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} is for a {' or '.join(shapes)}, this is a {shape}",
                "leave it out",
            )


def _mass_faults(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    if "mass" in data and "density" in data:
        message = "mass and density are two ways to say the same"
        yield Problem(document.span((*at, "density"), key=True), message, "keep one of them")
    elif is_free(data) and "mass" not in data and "density" not in data:
        message, hint = "a free object needs a mass", "add mass or density, or set fixed: true"
        yield Problem(document.span(at, key=True), message, hint)


def _faults_of_dimensions(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    shape = data["shape_type"]
    if "dimensions" not in data:
        message = f"a {shape} needs dimensions"
        yield Problem(document.span((*at, "shape_type")), message, f"they are {_FORMS[shape]}")
        return
    found = len(data["dimensions"])
    if found != _COUNTS[shape]:
        yield Problem(
            document.span((*at, "dimensions")),
            f"a {shape} has {_COUNTS[shape]} dimensions, found {found}",
            f"they are {_FORMS[shape]}",
        )
    elif 2 * data.get("edge_radius", 0) >= min(data["dimensions"]):
        half = min(data["dimensions"]) / 2
        yield Problem(
            document.span((*at, "edge_radius")),
            f"{data['edge_radius']:g} m is not less than half the shortest edge, {half:g} m",
            "give it a smaller radius, or take a sphere or a capsule",
        )
