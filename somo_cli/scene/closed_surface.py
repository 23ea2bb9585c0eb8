"""Clean the triangles of a closed surface, and order their vertices as seen from outside.

A surface is closed if every edge belongs to an even number of faces: two, or four where two bodies
touch along an edge or share a face. The divergence theorem gives volume and inertia if every edge
has as many faces that run along it in one direction as in the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]


_MOST_POINTS = 8  # of a shell that are looked at to find what it is inside of


@dataclass(frozen=True, slots=True)
class CleanSurface:
    """Triangles of vertex numbers, shape (n, 3), and the counts of those that were removed."""

    faces: Array
    duplicates: int
    degenerate: int


class OpenSurface(ValueError):
    """A surface that encloses no volume: the reason, and a hint how to correct it."""

    def __init__(self, message: str, hint: str) -> None:
        self.hint = hint
        super().__init__(message)


def clean_surface(faces: Array) -> CleanSurface:
    """Return the faces, shape (n, 3), without duplicates and without those of zero area.

    Zero area means that a face names a vertex twice. Two faces with the same vertices in opposite
    order are no duplicates: where two bodies share a face, each has one of them.
    """
    a, b, c = faces.T
    is_proper = (a != b) & (b != c) & (a != c)
    kept = faces[is_proper]
    first = np.argmin(kept, axis=1)
    turned = np.stack([kept[np.arange(len(kept)), (first + k) % 3] for k in range(3)], axis=1)
    _, places = np.unique(turned, axis=0, return_index=True)
    return CleanSurface(kept[np.sort(places)], len(kept) - len(places), int(len(faces) - len(kept)))


def outward_faces(vertices: Array, faces: Array) -> Array:
    """Return the faces of a closed surface, all counterclockwise as seen from outside.

    A shell inside another shell is a cavity. Raises OpenSurface.
    """
    _require_closed(faces)
    if not _is_balanced(faces):
        faces = _with_consistent_winding(vertices, faces)
    if not _is_balanced(faces):
        message = "its face normals do not show which side is inside"
        raise OpenSurface(message, "make the normals consistent")
    return _turned_outwards(vertices, faces)


def _edges(faces: Array) -> Array:
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def _require_closed(faces: Array) -> None:
    _, counts = np.unique(np.sort(_edges(faces), axis=1), axis=0, return_counts=True)
    if not (counts % 2).any():
        return
    few = (counts == 1).any()
    message = f"it is open: some edges belong to {'one face only' if few else 'three faces'}"
    raise OpenSurface(message, "close its holes, or set fixed: true")


def _is_balanced(faces: Array) -> bool:
    """Return whether as many faces run along every edge in one direction as in the other."""
    edges = _edges(faces)
    ends = np.sort(edges, axis=1)
    _, numbers = np.unique(ends, axis=0, return_inverse=True)
    directions = np.where(edges[:, 0] == ends[:, 0], 1, -1)
    return not np.bincount(numbers.ravel(), weights=directions).any()


def _with_consistent_winding(vertices: Array, faces: Array) -> Array:
    import trimesh

    mesh = trimesh.Trimesh(vertices, faces, process=False)
    repair: Any = trimesh.repair
    repair.fix_winding(mesh)
    return np.asarray(mesh.faces)


def _turned_outwards(vertices: Array, faces: Array) -> Array:
    """Return the faces, reversing each outermost shell that faces inwards, with all inside it.

    Such a shell has a negative volume by the divergence theorem.
    """
    import trimesh

    corners = vertices[faces]
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    graph: Any = trimesh.graph
    of_vertex = graph.connected_component_labels(_edges(faces), node_count=len(vertices))
    of_face = of_vertex[faces[:, 0]]
    shells = np.unique(of_face)
    enclosed = np.bincount(of_face, weights=volumes)
    low = {one: corners[of_face == one].min(axis=(0, 1)) for one in shells}
    high = {one: corners[of_face == one].max(axis=(0, 1)) for one in shells}

    def holds(outer: int, inner: int) -> bool:
        is_in_box = (low[outer] < low[inner]).all() and (high[inner] < high[outer]).all()
        return bool(is_in_box) and _encloses(
            corners[of_face == outer], vertices[np.unique(faces[of_face == inner])]
        )

    turned = faces.copy()
    for outer in shells:
        if enclosed[outer] >= 0 or any(holds(other, outer) for other in shells):
            continue
        for inner in (one for one in shells if one == outer or holds(outer, one)):
            turned[of_face == inner] = turned[of_face == inner][:, ::-1]
    return turned


def _encloses(shell: Array, points: Array) -> bool:
    """Whether most of some points, (m, 3), are inside a closed shell of triangles, (n, 3, 3).

    A point is inside where the shell fills the whole sphere around it: its triangles' solid angles,
    by van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125, add up to 4 π, else to 0.
    """
    some = points[:: max(1, len(points) // _MOST_POINTS)]
    inside = 0
    for point in some:
        a, b, c = np.moveaxis(shell - point, 1, 0)
        la, lb, lc = (np.linalg.norm(one, axis=1) for one in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        ab, bc, ca = (np.einsum("ij,ij->i", *pair) for pair in ((a, b), (b, c), (c, a)))
        angles = 2 * np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
        inside += abs(float(angles.sum())) > 2 * np.pi
    return 2 * inside > len(some)
