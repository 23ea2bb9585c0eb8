"""Check the shape and the mass of an object, beyond what the schema checks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.checks.meshes import mesh_problems

_DIMENSION_COUNTS = {"box": 3, "cylinder": 2, "sphere": 1, "capsule": 2}
_DIMENSION_FORMS = {
    "box": "[x, y, z]",
    "cylinder": "[height, radius]",
    "sphere": "[radius]",
    "capsule": "[height, radius]",
}
_SHAPES_BY_KEY = {
    "dimensions": tuple(_DIMENSION_COUNTS),
    "edge_radius": ("box",),
    "mesh": ("mesh",),
    "mesh_scale": ("mesh",),
    "urdf": ("urdf",),
    "hulls": ("mesh", "urdf"),
    "inertia": ("urdf",),
}
"""For each key that describes a shape, the shape types that it is for."""


def object_shape_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield the errors and warnings about shape and mass of the object `data` at `at`."""
    problems = list(_other_shape_key_problems(document, at, data))
    yield from problems
    yield from _mass_problems(document, at, data)
    if problems:
        return
    if data["shape_type"] in _DIMENSION_COUNTS:
        yield from _dimension_problems(document, at, data)
    elif data["shape_type"] not in data:
        shape = data["shape_type"]
        message, hint = f"shape_type {shape} needs a key '{shape}'", "give it the path of a file"
        yield Problem(document.span((*at, "shape_type")), message, hint)
    elif data["shape_type"] == "mesh":
        yield from mesh_problems(document, at, data, is_free(data))
    else:
        # imported here because it imports trimesh, which is slow to load
        from somo_cli.scene.checks.urdf_objects import urdf_problems

        yield from urdf_problems(document, at, data, is_free(data))


def is_free(data: Mapping[str, Any]) -> bool:
    """Return whether forces can move the object, so that it needs a mass."""
    return not data.get("fixed", False) and "motion" not in data


def _other_shape_key_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    shape = data["shape_type"]
    for key, shapes in _SHAPES_BY_KEY.items():
        if key in data and shape not in shapes:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} is for shape_type {', '.join(shapes)}, and this one is {shape}",
                "leave it out",
            )


def _mass_problems(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    if "mass" in data and "density" in data:
        message = "both mass and density are given"
        yield Problem(document.span((*at, "density"), key=True), message, "keep one of them")
    elif data["shape_type"] == "urdf":
        return
    elif is_free(data) and "mass" not in data and "density" not in data:
        message, hint = "a free object needs a mass", "add mass or density, or set fixed: true"
        yield Problem(document.span(at, key=True), message, hint)


def _dimension_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    shape = data["shape_type"]
    if "dimensions" not in data:
        message = f"a {shape} needs dimensions"
        yield Problem(
            document.span((*at, "shape_type")), message, f"they are {_DIMENSION_FORMS[shape]}"
        )
        return
    found = len(data["dimensions"])
    if found != _DIMENSION_COUNTS[shape]:
        yield Problem(
            document.span((*at, "dimensions")),
            f"a {shape} has {_DIMENSION_COUNTS[shape]} dimensions, found {found}",
            f"they are {_DIMENSION_FORMS[shape]}",
        )
    elif 2 * data.get("edge_radius", 0) >= min(data["dimensions"]):
        half = min(data["dimensions"]) / 2
        yield Problem(
            document.span((*at, "edge_radius")),
            f"edge_radius {data['edge_radius']:g} m is not less than half the shortest edge, "
            f"{half:g} m",
            "make it smaller, or use a sphere or a capsule",
        )
