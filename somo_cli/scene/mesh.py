"""Compute the convex hulls and the mass properties of the text of an OBJ or STL file.

Only this module uses trimesh, and loads it when a scene has a mesh.
"""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from somo_cli.manipulator.geometry import Vector, vector
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.solids import Inertial, lumped
from somo_cli.problems import MAX_NUMBER
from somo_cli.scene.closed_surface import OpenSurface, clean_surface, outward_faces

FORMATS = (".obj", ".stl")
MAX_HULL_VERTICES = 10_000
"""The most vertices of a hull. In PyBullet 3.2.7 a step of one body on a plane takes 3 times as
long with 5000 vertices as with 1000, and 12 times as long with 20 000."""

_MIN_RELATIVE_THICKNESS = 1e-6  # smallest extent divided by the largest
_MIN_VOLUME_SHARE = 1e-9  # volume of the solid divided by that of its hulls
_ROUNDING = 1e-15  # rounding error of a volume, divided by the cube of the largest extent
_MIN_EXTENT = 1e-6  # m; trimesh merges vertices that are 1e-8 apart


class MeshError(ValueError):
    """A mesh that cannot be used: what is wrong, with a hint how to mend it."""

    def __init__(self, message: str, hint: str) -> None:
        self.hint = hint
        super().__init__(message)


Hulls: TypeAlias = Literal["parts", "one", "decompose"]


class MeshFile(NamedTuple):
    """The name and text of a mesh file, and its convex pieces as an OBJ text, if known."""

    source: str
    text: str
    pieces: str | None = None


@dataclass(frozen=True, slots=True)
class MeshProperties:
    """Convex hulls, and the inertias at unit density of the hulls and of the mesh itself.

    If the mesh encloses no volume, `mesh_inertial` is None and `fault` says why. The solid leaves
    out duplicate faces and faces without area; the last two fields count them.
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
    """Return hulls and mass properties of a mesh file, its axes scaled by three factors.

    With `parts` each named part (`o`, `g`) of an OBJ has a hull of its own. With `one` a hull
    encloses all parts. With `decompose` each part of the OBJ text `pieces` has a hull. The default
    is `parts` if every part encloses a volume, else `one`. Hulls and centres are in the frame of
    the file; lengths are the scaled numbers of the file, taken as metres. Raises MeshError.
    """
    with np.errstate(all="ignore"):  # the checks below reject such numbers
        parts = _usable_parts(text, source, scale)
        solids = [_solid_of(part) for part in parts]
        if hulls is None:
            hulls = "parts" if all(one.inertial for one in solids) else "one"
        shapes = _pieces(pieces, scale) if hulls == "decompose" else parts
        if hulls == "one":
            shapes = [_joined(parts)]
        found = [_hull(shape.vertices) for shape in shapes]
        hull_inertial = lumped(tuple(inertial for _, inertial in found))
        whole = _whole_solid(parts, solids, _MIN_VOLUME_SHARE * hull_inertial.mass)
        return MeshProperties(
            tuple(hull for hull, _ in found),
            hull_inertial,
            whole.inertial,
            whole.fault,
            whole.hint,
            sum(one.duplicates for one in solids),
            sum(one.degenerate for one in solids),
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
        # without a handler, trimesh prints a traceback of each error that is reported below
        log.addHandler(logging.NullHandler())
    content = text.encode("utf-8", "surrogateescape")
    # trimesh 5.2 does not wrap the errors that its parsing causes
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
            # numpy before 2.3 only warns, and leaves out the numbers that it could not read
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
    except RuntimeError as error:  # scipy raises it if there is no hull
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
    """The inertia at unit density of the volume that faces enclose, or why there is none."""

    inertial: Inertial | None
    fault: str = ""
    hint: str = ""
    duplicates: int = 0
    degenerate: int = 0


def _whole_solid(parts: list[Any], solids: list[_Solid], min_volume: float) -> _Solid:
    """Return the solid of a mesh from its parts and their solids, if it exceeds `min_volume` [m^3].

    Where each part is solid, volumes add up. Else the parts may be one closed surface together.
    """
    inertials = tuple(one.inertial for one in solids if one.inertial)
    if len(inertials) == len(parts):
        whole = _Solid(lumped(inertials))
    else:
        whole = solids[0] if len(parts) == 1 else _solid_of(_joined(parts))
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
