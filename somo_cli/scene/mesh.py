"""The text of an OBJ or STL file to its convex hulls and its mass properties.

The only place trimesh is known; it is loaded when a scene has a mesh.
"""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from somo_cli.document.validate import MAX_NUMBER
from somo_cli.manipulator.geometry import Vector, vector
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.solids import Inertial, lumped
from somo_cli.scene.closed_surface import OpenSurface, clean_surface, outward_faces

FORMATS = (".obj", ".stl")
MAX_HULL_VERTICES = 10_000
"""Of a hull. Seen in PyBullet 3.2.7: a step of one body on a plane costs 3 times as much with 5000
vertices as with 1000, and 12 times as much with 20 000."""

_MIN_RELATIVE_THICKNESS = 1e-6  # extent across by the largest extent
_MIN_VOLUME_SHARE = 1e-9  # of the hull, that a solid fills
_ROUNDING = 1e-15  # of the cube of an extent
_MIN_EXTENT = 1e-6  # m; trimesh takes vertices that are 1e-8 apart for one


class MeshError(ValueError):
    """A mesh that the engine, or nobody, can use: what is wrong, and what would be right."""

    def __init__(self, message: str, hint: str) -> None:
        self.hint = hint
        super().__init__(message)


Hulls: TypeAlias = Literal["parts", "one", "decompose"]


class MeshFile(NamedTuple):
    """A mesh file: what it is called, its text, and an OBJ text of its convex pieces, if known."""

    source: str
    text: str
    pieces: str | None = None


@dataclass(frozen=True, slots=True)
class MeshProperties:
    """Convex hulls, and the solids of unit density that fill the hulls and the mesh itself.

    Of a mesh that encloses no volume `mesh_inertial` is None, and `fault` says why. Faces that
    repeat others, and those without an area, are left out of the solid, and counted.
    """

    hulls: tuple[Hull, ...]
    hull_inertial: Inertial
    mesh_inertial: Inertial | None
    fault: str = ""
    hint: str = ""
    duplicate_faces: int = 0
    degenerate_faces: int = 0

    @property
    def hull(self) -> Hull:
        """The first hull, which most meshes have only one of."""
        return self.hulls[0]


@lru_cache(maxsize=64)
def mesh_properties(
    text: str,
    source: str,
    scale: Vector = (1.0, 1.0, 1.0),
    hulls: Hulls | None = None,
    pieces: str | None = None,
) -> MeshProperties:
    """Return hulls and mass properties of a mesh file, its axes scaled by three factors.

    With `parts` each named part (`o`, `g`) of an OBJ has a hull of its own, with `one` there is
    one around all, with `decompose` there is one for each part of the OBJ text `pieces`. By default
    it is `parts` where every part encloses a volume, else `one`. Hulls and centres are in the frame
    of the file, in metres if it is. Raises MeshError.
    """
    with np.errstate(all="ignore"):  # of numbers that are refused below
        parts = _usable_parts(text, source, scale)
        solids_of_parts = [_solid_of(part) for part in parts]
        are_solid = all(one.inertial for one in solids_of_parts)
        whole = solids_of_parts[0] if len(parts) == 1 else _solid_of(_joined(parts))
        inertial = whole.inertial
        if are_solid:
            inertial = lumped(tuple(one.inertial for one in solids_of_parts if one.inertial))
        if hulls == "decompose":
            shapes = _pieces(pieces, scale)
        elif hulls == "parts" or (hulls is None and are_solid):
            shapes = parts
        else:
            shapes = [_joined(parts)]
        found = [_hull(part.vertices) for part in shapes]
        hull_inertial = lumped(tuple(inertial for _, inertial in found))
        fault, hint = ("", "") if inertial else (whole.fault, whole.hint)
        if inertial and not inertial.mass > _MIN_VOLUME_SHARE * hull_inertial.mass:
            inertial, fault, hint = None, "it encloses no volume", "give it a thickness"
        return MeshProperties(
            tuple(hull for hull, _ in found),
            hull_inertial,
            inertial,
            fault,
            hint,
            sum(one.duplicates for one in solids_of_parts),
            sum(one.degenerate for one in solids_of_parts),
        )


def triangles_as_obj(text: str, source: str) -> str:
    """Return a mesh file as an OBJ of triangles without parts, for other programs to read.

    Raises MeshError.
    """
    mesh = _joined(_usable_parts(text, source, (1.0, 1.0, 1.0)))
    lines = ["v " + " ".join(map(repr, row)) for row in mesh.vertices.tolist()]
    lines += ["f " + " ".join(str(1 + corner) for corner in row) for row in mesh.faces.tolist()]
    return "\n".join(lines) + "\n"


def _usable_parts(text: str, source: str, scale: Vector) -> list[Any]:
    parts = _load_parts(text, source)
    for part in parts:
        _require_usable(part)
        part.apply_scale(scale)
        _require_bounded(part)
    return parts


def _pieces(pieces: str | None, scale: Vector) -> list[Any]:
    if pieces is None:
        message = "it cannot be decomposed: the engine, PyBullet, is not installed"
        raise MeshError(message, "set hulls: parts, or hulls: one")
    return _usable_parts(pieces, "pieces.obj", scale)


def _joined(parts: list[Any]) -> Any:
    import trimesh

    if len(parts) == 1:
        return parts[0]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=True)]
    vertices = np.concatenate([part.vertices for part in parts])
    return trimesh.Trimesh(vertices, np.concatenate(faces), process=False)


def _load_parts(text: str, source: str) -> list[Any]:
    import trimesh

    kind = next((one for one in FORMATS if source.lower().endswith(one)), None)
    if kind is None:
        raise MeshError("this is neither an OBJ nor an STL file", "the name ends in .obj or .stl")
    log = logging.getLogger("trimesh")
    if not log.handlers:
        # it would print tracebacks of what its parsing stumbles over, which is told below
        log.addHandler(logging.NullHandler())
    content = text.encode("utf-8", "surrogateescape")
    # trimesh 5.2 lets through whatever its parsing stumbles over
    parsing_errors = (
        *(ValueError, IndexError, KeyError, TypeError, AttributeError, OverflowError),
        DeprecationWarning,
    )
    options: dict[str, Any] = {}
    if kind == ".obj":
        options = {"skip_materials": True, "group_material": False}
        options |= {"split_objects": True, "split_groups": True}
    try:
        with warnings.catch_warnings():
            # numpy before 2.3 leaves it at that, and what it could not read out
            warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
            scene = trimesh.load_scene(
                BytesIO(content), file_type=kind[1:], process=False, **options
            )
    except parsing_errors as error:
        reason = (str(error).splitlines() or [""])[0]
        raise MeshError(
            f"this cannot be read: {reason}", "export it again, as triangles"
        ) from error
    # seen in trimesh 5.2: the parts come out last first
    found = [one for one in reversed(scene.geometry.values()) if hasattr(one, "faces")]
    if not any(len(one.faces) for one in found):
        raise MeshError("there are no faces in it", "export it again, as triangles")
    return [one for one in found if len(one.faces)]


def _require_usable(mesh: Any) -> None:
    hint = "export it again, as triangles"
    if mesh.vertices.ndim != 2 or mesh.vertices.shape[1:] != (3,) or not len(mesh.faces):
        raise MeshError("there are no faces in it", hint)
    if not np.isfinite(mesh.vertices).all():
        raise MeshError("one of its vertices is not finite", hint)
    if not (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices)):
        raise MeshError("a face names a vertex that is not there", hint)


def _require_bounded(mesh: Any) -> None:
    extent = float(np.abs(mesh.vertices).max())
    if extent > MAX_NUMBER:
        message = f"one of its vertices is at {extent:.3g} m"
        raise MeshError(message, f"no number may be larger than {MAX_NUMBER:g}")


def _hull(vertices: Any) -> tuple[Hull, Inertial]:
    import trimesh

    flat = MeshError("it is flat, so its hull encloses no volume", "give it a thickness")
    extent = float(np.ptp(vertices, axis=0).max())
    if extent < _MIN_EXTENT:
        raise MeshError(f"it is {extent:.3g} m long", "enlarge it with mesh_scale")
    spread = np.linalg.svd(vertices - vertices.mean(axis=0), compute_uv=False)
    if len(vertices) < 4 or spread[2] <= _MIN_RELATIVE_THICKNESS * spread[0]:
        raise flat
    try:
        # Qt: triangles only; the default of trimesh may shift the points
        hull = trimesh.convex.convex_hull(vertices, qhull_options="Qt")
    except RuntimeError as error:  # as scipy calls it when there is no hull
        raise flat from error
    if len(hull.vertices) > MAX_HULL_VERTICES:
        raise MeshError(
            f"its hull has {len(hull.vertices)} vertices, and {MAX_HULL_VERTICES} are the most",
            "export a coarser one",
        )
    found = Hull(
        tuple(vector(row) for row in hull.vertices.tolist()),
        tuple((int(a), int(b), int(c)) for a, b, c in hull.faces.tolist()),
    )
    return found, _inertial(hull)


@dataclass(frozen=True, slots=True)
class _Solid:
    """The homogeneous solid of unit density that faces enclose, if they do, else why not."""

    inertial: Inertial | None
    fault: str = ""
    hint: str = ""
    duplicates: int = 0
    degenerate: int = 0


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
    # the hull may be flat as well, so it is the box around that rounding is compared with
    if not inertial.mass > _ROUNDING * float(np.ptp(merged.vertices, axis=0).max()) ** 3:
        return _Solid(None, "it encloses no volume", "give it a thickness", *counts)
    return _Solid(inertial, "", "", *counts)


def _inertial(mesh: Any) -> Inertial:
    found = mesh.mass_properties
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = found["inertia"].tolist()
    density = float(found["density"])
    inertia = (xx / density, xy / density, xz / density, yy / density, yz / density, zz / density)
    return Inertial(float(found["volume"]), vector(found["center_mass"].tolist()), inertia)
