"""Triangles that close around a volume: cleaned, turned outwards, and the solid inside.

A surface is closed where every edge has an even number of faces: two, or four where two bodies
touch in an edge or share a face. Volume and inertia are then those of the divergence theorem, if
faces run along each edge as often one way as the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]


@dataclass(frozen=True, slots=True)
class CleanSurface:
    """Triangles, shape (n, 3), of a mesh whose vertices are merged, and what was left out."""

    faces: Array
    duplicates: int
    degenerate: int


class OpenSurface(ValueError):
    """A surface that encloses nothing: what is wrong with it, and what would be right."""

    def __init__(self, message: str, hint: str) -> None:
        self.hint = hint
        super().__init__(message)


def clean_surface(faces: Array) -> CleanSurface:
    """Return faces without those that name a vertex twice, and without repeated ones.

    A face with the same corners seen from the other side is not a repetition: where two bodies
    share a face, both have it.
    """
    a, b, c = faces.T
    is_proper = (a != b) & (b != c) & (a != c)
    kept = faces[is_proper]
    first = np.argmin(kept, axis=1)
    turned = np.stack([kept[np.arange(len(kept)), (first + k) % 3] for k in range(3)], axis=1)
    _, places = np.unique(turned, axis=0, return_index=True)
    return CleanSurface(kept[np.sort(places)], len(kept) - len(places), int(len(faces) - len(kept)))


def outward_faces(vertices: Array, faces: Array) -> Array:
    """Return the faces of a closed surface, all seen counterclockwise from outside.

    A shell inside another is a cavity. Raises OpenSurface.
    """
    _require_closed(faces)
    if not _is_balanced(faces):
        faces = _with_consistent_winding(vertices, faces)
    if not _is_balanced(faces):
        message = "its faces do not tell inside from outside"
        raise OpenSurface(message, "make its normals consistent")
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
    """Whether faces run along every edge as often one way as the other."""
    edges = _edges(faces)
    ends = np.sort(edges, axis=1)
    _, numbers = np.unique(ends, axis=0, return_inverse=True)
    ways = np.where(edges[:, 0] == ends[:, 0], 1, -1)
    return not np.bincount(numbers.ravel(), weights=ways).any()


def _with_consistent_winding(vertices: Array, faces: Array) -> Array:
    import trimesh

    mesh = trimesh.Trimesh(vertices, faces, process=False)
    repair: Any = trimesh.repair
    repair.fix_winding(mesh)
    return np.asarray(mesh.faces)


def _turned_outwards(vertices: Array, faces: Array) -> Array:
    """Return the faces with every outermost shell turned, and what is inside with it, if need be.

    The volume that a shell encloses is negative where it is seen from inside.
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
        return bool((low[outer] < low[inner]).all() and (high[inner] < high[outer]).all())

    turned = faces.copy()
    for outer in shells:
        if enclosed[outer] >= 0 or any(holds(other, outer) for other in shells):
            continue
        for inner in (one for one in shells if one == outer or holds(outer, one)):
            turned[of_face == inner] = turned[of_face == inner][:, ::-1]
    return turned
