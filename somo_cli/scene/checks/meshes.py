"""Check meshes: volume that their hulls add, faces that are ignored, and implausible sizes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.hull import Hull
from somo_cli.problems import Pointer, Problem, Span
from somo_cli.scene import object_shapes

if TYPE_CHECKING:
    from somo_cli.scene.mesh import MeshProperties

_MAX_HULL_SURPLUS = 0.05  # volume that the hulls add, divided by that of the mesh
_MAX_PLAUSIBLE_SIZE = 10.0  # m


def mesh_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_free: bool
) -> Iterator[Problem]:
    """Yield the errors and warnings about the meshes of the object `data` at `at`."""
    from somo_cli.scene.mesh_parts import MeshError

    for index, file in enumerate(object_shapes.mesh_files(data["mesh"])):
        place = (*at, "mesh", index) if isinstance(data["mesh"], list) else (*at, "mesh")
        span, name = document.span(place), f"'{file['source']}'"
        try:
            found = object_shapes.measured_mesh(data, file)
        except MeshError as error:
            yield Problem(span, f"{name}: {error}", error.hint)
            continue
        if found.mesh_inertial is None and is_free:
            yield Problem(span, f"{name}: {found.reason}", found.hint)
            continue
        yield from _face_warnings(span, name, found)
        if data.get("collides", True):
            yield from hull_warnings(span, name, found)
        yield from _size_warnings(span, name, found.hulls)


def hull_warnings(span: Span, name: str, found: MeshProperties) -> Iterator[Problem]:
    """Yield a warning if the hulls of a mesh enclose clearly more volume than the mesh."""
    if found.mesh_inertial is None:
        return
    surplus = found.hull_inertial.mass / found.mesh_inertial.mass - 1
    if surplus > _MAX_HULL_SURPLUS:
        count = len(found.hulls)
        hulls = "its convex hull, which has" if count == 1 else f"its {count} hulls, which have"
        message = f"{name} collides as {hulls} {100 * surplus:.0f} % more volume"
        hint = "set hulls: decompose, or give a list of convex parts"
        yield Problem(span, message, hint, "warning")


def _face_warnings(span: Span, name: str, found: MeshProperties) -> Iterator[Problem]:
    ignored = []
    if found.duplicate_faces:
        ignored.append(_counted(found.duplicate_faces, "duplicate face"))
    if found.degenerate_faces:
        ignored.append(f"{_counted(found.degenerate_faces, 'face')} without area")
    if ignored:
        hint = "remove them from the mesh if they are a mistake"
        yield Problem(span, f"{name}: {' and '.join(ignored)} ignored", hint, "warning")


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _size_warnings(span: Span, name: str, hulls: tuple[Hull, ...]) -> Iterator[Problem]:
    points = [vertex for hull in hulls for vertex in hull.vertices]
    x, y, z = (max(axis) - min(axis) for axis in zip(*points, strict=True))
    if max(x, y, z) > _MAX_PLAUSIBLE_SIZE:
        message = f"{name} is {max(x, y, z):.3g} m long"
        hint = "if its lengths are in millimetres, set mesh_scale: 0.001"
        yield Problem(span, message, hint, "warning")
