"""Faults of the shape and the mass of an object: what a schema cannot say of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import solids
from somo_cli.manipulator.hull import Hull
from somo_cli.problems import Pointer, Problem, Span
from somo_cli.scene import compound, object_shapes

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
    "mass": (*_DIMENSION_COUNTS, "mesh"),
    "density": (*_DIMENSION_COUNTS, "mesh"),
}
"""Each key that says a shape, and the shapes that it is for."""

_MAX_HULL_SURPLUS = 0.05  # of the volume, that a hull adds
_MAX_PLAUSIBLE_SIZE = 10.0  # m


def object_shape_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield the faults of shape and mass of the object `data` at `at`."""
    problems = list(_other_shape_key_problems(document, at, data))
    yield from problems
    if data["shape_type"] != "urdf":
        yield from _mass_problems(document, at, data)
    if problems:
        return
    if data["shape_type"] in _DIMENSION_COUNTS:
        yield from _dimension_problems(document, at, data)
    elif data["shape_type"] not in data:
        shape = data["shape_type"]
        message, hint = f"shape_type {shape} needs a key '{shape}'", "the path of a file"
        yield Problem(document.span((*at, "shape_type")), message, hint)
    elif data["shape_type"] == "mesh":
        yield from _mesh_problems(document, at, data)
    else:
        yield from _urdf_problems(document, at, data)


def is_free(data: Mapping[str, Any]) -> bool:
    """Whether forces move the object, so that its mass counts."""
    return not data.get("fixed", False) and "motion" not in data


def _other_shape_key_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    shape = data["shape_type"]
    for key, shapes in _SHAPES_BY_KEY.items():
        if key in data and shape not in shapes:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} is for shape_type {', '.join(shapes)}, this one is {shape}",
                "the masses are in the file" if key in ("mass", "density") else "leave it out",
            )


def _mass_problems(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    if "mass" in data and "density" in data:
        message = "mass and density are two ways to say the same"
        yield Problem(document.span((*at, "density"), key=True), message, "keep one of them")
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
            f"{data['edge_radius']:g} m is not less than half the shortest edge, {half:g} m",
            "give it a smaller radius, or take a sphere or a capsule",
        )


def _mesh_problems(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    from somo_cli.scene.mesh import MeshError, mesh_properties

    files = object_shapes.mesh_files(data["mesh"])
    for index, file in enumerate(files):
        place = (*at, "mesh", index) if isinstance(data["mesh"], list) else (*at, "mesh")
        span = document.span(place)
        try:
            found = mesh_properties(
                file["text"], file["source"], object_shapes.mesh_axis_factors(data)
            )
        except MeshError as error:
            yield Problem(span, f"'{file['source']}': {error}", error.hint)
            continue
        if found.mesh_inertial is None:
            if is_free(data):
                yield Problem(span, f"'{file['source']}': {found.fault}", found.hint)
            continue
        surplus = found.hull_inertial.mass / found.mesh_inertial.mass - 1
        if surplus > _MAX_HULL_SURPLUS:
            yield Problem(
                span,
                f"'{file['source']}' is touched as its convex hull, which has "
                f"{100 * surplus:.0f} % more volume",
                "give a list of convex parts",
                "warning",
            )
        yield from _size_warnings(span, file["source"], found.hull)


def _size_warnings(span: Span, source: str, hull: Hull) -> Iterator[Problem]:
    x, y, z = (max(axis) - min(axis) for axis in zip(*hull.vertices, strict=True))
    if max(x, y, z) > _MAX_PLAUSIBLE_SIZE:
        message = f"'{source}' is {max(x, y, z):.3g} m long"
        hint = "if its lengths are millimetres: mesh_scale: 0.001"
        yield Problem(span, message, hint, "warning")


def _urdf_problems(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    body = object_shapes.object_urdf_body(data)
    yield from body.problems
    if body.problems:
        return
    count = compound.shape_count([one.solid for one in body.solids])
    if count > compound.MAX_SHAPES:
        message = f"it has {count} shapes, a capsule counting as three, and the engine takes "
        yield Problem(body.span, f"{message}{compound.MAX_SHAPES}", "leave some out")
    if not is_free(data):
        return
    for name, span in body.links_without_inertia:
        message = f"link '{name}' has a shape and no inertia"
        yield Problem(span, message, "give it <inertial>, or the object fixed: true")
    if body.links_without_inertia:
        return
    if not body.inertials:
        message = "no link has a mass"
        yield Problem(body.span, message, "give one <inertial>, or the object fixed: true")
        return
    _, moments = compound.principal_axes(solids.lumped(tuple(body.inertials)).inertia)
    if not min(moments) > 0:
        message = f"the moments of inertia of the whole are {moments[0]:.3g}, {moments[1]:.3g} and "
        hint = "all three are greater than 0"
        yield Problem(body.span, f"{message}{moments[2]:.3g} kg·m²", hint)
