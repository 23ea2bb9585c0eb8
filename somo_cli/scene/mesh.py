"""The text of an OBJ or STL file to its convex hull and its mass properties.

The only place trimesh is known; it is loaded when a scene has a mesh.
"""

from __future__ import annotations

import logging
import warnings
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from typing import Any

import numpy as np

from somo_cli.manipulator.geometry import Vector, vector
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.solids import Inertial

FORMATS = (".obj", ".stl")
MAX_HULL_VERTICES = 10_000
"""Of a hull. Seen in PyBullet 3.2.7: a step of one body on a plane costs 3 times as much with 5000
vertices as with 1000, and 12 times as much with 20 000."""

_MIN_RELATIVE_THICKNESS = 1e-6  # extent across by the largest extent
_MIN_EXTENT = 1e-6  # m; trimesh takes vertices that are 1e-8 apart for one


class MeshError(ValueError):
    """A mesh that the engine, or nobody, can use: what is wrong, and what would be right."""

    def __init__(self, message: str, hint: str) -> None:
        self.hint = hint
        super().__init__(message)


@dataclass(frozen=True, slots=True)
class MeshProperties:
    """A hull, and the solids of unit density that fill the hull and the mesh itself.

    Of a mesh that encloses no volume `mesh_inertial` is None, and `fault` says why.
    """

    hull: Hull
    hull_inertial: Inertial
    mesh_inertial: Inertial | None
    fault: str = ""
    hint: str = ""


@lru_cache(maxsize=64)
def mesh_properties(text: str, source: str, scale: Vector = (1.0, 1.0, 1.0)) -> MeshProperties:
    """Return hull and mass properties of a mesh file, its axes scaled by three factors.

    Hull and centres are in the frame of the file, in metres if it is. Raises MeshError.
    """
    with np.errstate(all="ignore"):  # of numbers that are refused below
        mesh = _load_mesh(text, source)
        _require_usable(mesh)
        mesh.apply_scale(scale)
        hull, hull_inertial = _hull(mesh.vertices)
        try:
            return MeshProperties(hull, hull_inertial, _solid(mesh, hull_inertial.mass))
        except MeshError as error:
            return MeshProperties(hull, hull_inertial, None, str(error), error.hint)


def _load_mesh(text: str, source: str) -> Any:
    import trimesh

    kind = next((one for one in FORMATS if source.lower().endswith(one)), None)
    if kind is None:
        raise MeshError("this is neither an OBJ nor an STL file", "the name ends in .obj or .stl")
    log = logging.getLogger("trimesh")
    if not log.handlers:
        # it would print tracebacks of what it parsing_errors over, which is told below
        log.addHandler(logging.NullHandler())
    content = text.encode("utf-8", "surrogateescape")
    # trimesh 5.2 lets through whatever its parsing parsing_errors over
    parsing_errors = (
        *(ValueError, IndexError, KeyError, TypeError, AttributeError, OverflowError),
        DeprecationWarning,
    )
    options = {"skip_materials": True} if kind == ".obj" else {}
    try:
        with warnings.catch_warnings():
            # numpy before 2.3 leaves it at that, and what it could not read out
            warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
            mesh = trimesh.load_mesh(BytesIO(content), file_type=kind[1:], process=False, **options)
    except parsing_errors as error:
        reason = (str(error).splitlines() or [""])[0]
        raise MeshError(
            f"this cannot be read: {reason}", "export it again, as triangles"
        ) from error
    return mesh


def _require_usable(mesh: Any) -> None:
    hint = "export it again, as triangles"
    if mesh.vertices.ndim != 2 or mesh.vertices.shape[1:] != (3,) or not len(mesh.faces):
        raise MeshError("there are no faces in it", hint)
    if not np.isfinite(mesh.vertices).all():
        raise MeshError("one of its vertices is not finite", hint)
    if not (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices)):
        raise MeshError("a face names a vertex that is not there", hint)


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


def _solid(mesh: Any, volume_of_hull: float) -> Inertial:
    """Return the homogeneous solid of unit density that the faces enclose."""
    import trimesh

    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    if not mesh.is_watertight:
        raise MeshError(
            "it is open: some edges belong to one face only", "close its holes, or set fixed: true"
        )
    if not mesh.is_winding_consistent:
        repair: Any = trimesh.repair
        repair.fix_winding(mesh)
    if not mesh.is_winding_consistent:
        raise MeshError("its faces do not tell inside from outside", "make its normals consistent")
    if mesh.volume < 0:
        mesh.invert()
    if not mesh.volume > 1e-9 * volume_of_hull:
        raise MeshError("it encloses no volume", "give it a thickness")
    return _inertial(mesh)


def _inertial(mesh: Any) -> Inertial:
    found = mesh.mass_properties
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = found["inertia"].tolist()
    density = float(found["density"])
    inertia = (xx / density, xy / density, xz / density, yy / density, yz / density, zz / density)
    return Inertial(float(found["volume"]), vector(found["center_mass"].tolist()), inertia)
