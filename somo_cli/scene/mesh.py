"""Compute the convex hulls and the mass properties of the text of an OBJ or STL file.

This module and those that it imports use trimesh, and load it only if a scene has a mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from somo_cli.manipulator.geometry import Vector, vector
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.solids import Inertial, lumped
from somo_cli.scene.closed_surface import OpenSurface, clean_surface, outward_faces
from somo_cli.scene.mesh_parts import MeshError, joined, usable_parts

MAX_HULL_VERTICES = 10_000
"""The largest number of vertices of a hull. In PyBullet 3.2.7 a step of one body on a plane takes
3 times as long with 5000 vertices as with 1000, and 12 times as long with 20 000."""

_MIN_RELATIVE_THICKNESS = 1e-6  # smallest extent divided by the largest
_MIN_VOLUME_SHARE = 1e-9  # volume of the solid divided by that of its hulls
_ROUNDING = 1e-15  # rounding error of a volume, divided by the cube of the largest extent
_MIN_EXTENT = 1e-6  # m; trimesh merges vertices that are 1e-8 apart


Hulls: TypeAlias = Literal["parts", "one", "decompose"]


class MeshFile(NamedTuple):
    """The name and text of a mesh file, and its convex pieces as an OBJ text, if known."""

    source: str
    text: str
    pieces: str | None = None


@dataclass(frozen=True, slots=True)
class MeshProperties:
    """Convex hulls, and the mass properties at unit density of the hulls and of the mesh itself.

    If the mesh encloses no volume, `mesh_inertial` is None and `reason` says why. The mass
    properties ignore duplicate faces and faces without area; the last two fields count them.
    """

    hulls: tuple[Hull, ...]
    hull_inertial: Inertial
    mesh_inertial: Inertial | None
    reason: str = ""
    hint: str = ""
    duplicate_faces: int = 0
    degenerate_faces: int = 0

    @property
    def hull(self) -> Hull:
        """The first hull; most meshes have no other."""
        return self.hulls[0]


@lru_cache(maxsize=64)
def mesh_properties(
    text: str,
    source: str,
    scale: Vector = (1.0, 1.0, 1.0),
    hulls: Hulls | None = None,
    pieces: str | None = None,
) -> MeshProperties:
    """Return hulls and mass properties of a mesh file, with the axes scaled by three factors.

    With `parts` each named part (`o`, `g`) of an OBJ has its own hull. With `one` a single hull
    encloses all parts. With `decompose` each part of the OBJ text `pieces` has a hull. The default
    is `parts` if every part encloses a volume, else `one`. Hulls and centres of mass are in the
    frame of the file; the scaled numbers of the file are lengths in metres. Raises MeshError.
    """
    with np.errstate(all="ignore"):  # the checks below reject such numbers
        parts = usable_parts(text, source, scale)
        solids = [_solid_of(part) for part in parts]
        if hulls is None:
            hulls = "parts" if all(one.inertial for one in solids) else "one"
        shapes = _pieces(pieces, scale) if hulls == "decompose" else parts
        if hulls == "one":
            shapes = [joined(parts)]
        found = [_hull(shape.vertices) for shape in shapes]
        hull_inertial = lumped(tuple(inertial for _, inertial in found))
        whole = _whole_solid(parts, solids, _MIN_VOLUME_SHARE * hull_inertial.mass)
        return MeshProperties(
            tuple(hull for hull, _ in found),
            hull_inertial,
            whole.inertial,
            whole.reason,
            whole.hint,
            sum(one.duplicates for one in solids),
            sum(one.degenerate for one in solids),
        )


def triangles_as_obj(text: str, source: str) -> str:
    """Return a mesh file as an OBJ text of triangles without parts, for other programs.

    Raises MeshError.
    """
    mesh = joined(usable_parts(text, source, (1.0, 1.0, 1.0)))
    lines = ["v " + " ".join(map(repr, row)) for row in mesh.vertices.tolist()]
    lines += ["f " + " ".join(str(1 + corner) for corner in row) for row in mesh.faces.tolist()]
    return "\n".join(lines) + "\n"


def _pieces(pieces: str | None, scale: Vector) -> list[Any]:
    if pieces is None:
        message = "it cannot be decomposed: the engine, PyBullet, is not installed"
        raise MeshError(message, "set hulls: parts, or hulls: one")
    return usable_parts(pieces, "pieces.obj", scale)


def _hull(vertices: Any) -> tuple[Hull, Inertial]:
    import trimesh

    flat = MeshError("it is flat, so its hull encloses no volume", "give it a thickness")
    extent = float(np.ptp(vertices, axis=0).max())
    if extent < _MIN_EXTENT:
        raise MeshError(f"it is only {extent:.3g} m long", "enlarge it with mesh_scale")
    spread = np.linalg.svd(vertices - vertices.mean(axis=0), compute_uv=False)
    if len(vertices) < 4 or spread[2] <= _MIN_RELATIVE_THICKNESS * spread[0]:
        raise flat
    try:
        # Qt: triangles only; the default of trimesh may shift the points
        hull = trimesh.convex.convex_hull(vertices, qhull_options="Qt")
    except RuntimeError as error:  # scipy raises it if there is no hull
        raise flat from error
    if len(hull.vertices) > MAX_HULL_VERTICES:
        raise MeshError(
            f"its hull has {len(hull.vertices)} vertices; at most {MAX_HULL_VERTICES} are allowed",
            "export a coarser mesh",
        )
    found = Hull(
        tuple(vector(row) for row in hull.vertices.tolist()),
        tuple((int(a), int(b), int(c)) for a, b, c in hull.faces.tolist()),
    )
    return found, _inertial(hull)


@dataclass(frozen=True, slots=True)
class _Solid:
    """The mass properties at unit density of the volume that faces enclose, or why it has none."""

    inertial: Inertial | None
    reason: str = ""
    hint: str = ""
    duplicates: int = 0
    degenerate: int = 0


def _whole_solid(parts: list[Any], solids: list[_Solid], min_volume: float) -> _Solid:
    """Return the solid of a mesh from its parts and their solids, if it exceeds `min_volume` [m³].

    If each part is solid, their volumes add up. If not, the parts may form one closed surface.
    """
    inertials = tuple(one.inertial for one in solids if one.inertial)
    if len(inertials) == len(parts):
        whole = _Solid(lumped(inertials))
    else:
        whole = solids[0] if len(parts) == 1 else _solid_of(joined(parts))
    if whole.inertial and not whole.inertial.mass > min_volume:
        return _Solid(None, "it encloses no volume", "give it a thickness")
    return whole


def _solid_of(mesh: Any) -> _Solid:
    import trimesh

    merged = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    merged.merge_vertices(merge_tex=True, merge_norm=True)
    clean = clean_surface(np.asarray(merged.faces))
    counts = clean.duplicates, clean.degenerate
    if not len(clean.faces):
        return _Solid(None, "none of its faces has an area", "export it again", *counts)
    try:
        faces = outward_faces(np.asarray(merged.vertices), clean.faces)
    except OpenSurface as error:
        return _Solid(None, str(error), error.hint, *counts)
    inertial = _inertial(trimesh.Trimesh(merged.vertices, faces, process=False))
    # compared with the bounding box, because the volume of the hull may be zero as well
    if not inertial.mass > _ROUNDING * float(np.ptp(merged.vertices, axis=0).max()) ** 3:
        return _Solid(None, "it encloses no volume", "give it a thickness", *counts)
    return _Solid(inertial, "", "", *counts)


def _inertial(mesh: Any) -> Inertial:
    found = mesh.mass_properties
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = found["inertia"].tolist()
    density = float(found["density"])
    inertia = (xx / density, xy / density, xz / density, yy / density, yz / density, zz / density)
    return Inertial(float(found["volume"]), vector(found["center_mass"].tolist()), inertia)
