"""Triangles of the surface of a solid, with normals for smooth shading."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import Box, Cylinder, Sphere

Array: TypeAlias = NDArray[Any]

FACETS_AROUND_AXIS = 48
_ROWS_TO_POLE = 12  # rows of facets from the equator of a ball to a pole


@dataclass(frozen=True, slots=True)
class Facets:
    """Vertices and their outward unit normals, shape (n, 3), and triangles, shape (m, 3).

    They are in the frame and the unit of the solid. Triangles are indices of vertices,
    counterclockwise seen from outside.
    """

    vertices: Array
    normals: Array
    triangles: Array

    def scaled(self, factor: float) -> Facets:
        """Return the facets scaled by a factor about the origin of the frame."""
        return Facets(self.vertices * factor, self.normals, self.triangles)


@singledispatch
def facets(solid: object) -> Facets:
    """Return the facets of a solid."""
    raise TypeError(f"{type(solid).__name__} is not a solid that can be drawn")


@facets.register
def _(solid: Box) -> Facets:
    x, y, z = solid.size
    return _ball((x / 2, y / 2, z / 2), 0.0)


@facets.register
def _(solid: RoundedBox) -> Facets:
    return _ball(solid.core, solid.radius)


@facets.register
def _(solid: Sphere) -> Facets:
    return _revolved(_arc(solid.radius, 0.0, -_ROWS_TO_POLE, _ROWS_TO_POLE))


@facets.register
def _(solid: Capsule) -> Facets:
    half = solid.length / 2
    ends = (
        _arc(solid.radius, -half, -_ROWS_TO_POLE, 0),
        _arc(solid.radius, half, 0, _ROWS_TO_POLE),
    )
    return _revolved(np.concatenate(ends))


@facets.register
def _(solid: Hull) -> Facets:
    return _flat(np.array(solid.vertices), np.array(solid.faces))


@facets.register
def _(solid: Cylinder) -> Facets:
    half, radius = solid.length / 2, solid.radius
    # outline from bottom to top: distance from the axis, height, and the normal in these axes
    return _revolved(
        np.array(
            [
                [0, -half, 0, -1],
                [radius, -half, 0, -1],
                [radius, -half, 1, 0],
                [radius, half, 1, 0],
                [radius, half, 0, 1],
                [0, half, 0, 1],
            ]
        )
    )


def _arc(radius: float, height: float, first: int, last: int) -> Array:
    """Return the outline of a ball at a height, between two rows counted from its equator."""
    angles = np.arange(first, last + 1) * (math.pi / 2 / _ROWS_TO_POLE)
    out, up = np.cos(angles), np.sin(angles)
    return np.stack([radius * out, height + radius * up, out, up], axis=1)


def _revolved(outline: Array) -> Facets:
    """Return the surface that an outline, shape (k, 4), sweeps around the z axis."""
    angles = np.arange(FACETS_AROUND_AXIS + 1) * (2 * math.pi / FACETS_AROUND_AXIS)
    out = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    distance, height, across, along = (column[:, None, None] for column in outline.T)
    flat = np.ones((1, FACETS_AROUND_AXIS + 1, 1))
    vertices = np.concatenate([distance * out, height * flat], axis=2)
    normals = np.concatenate([across * out, along * flat], axis=2)
    return Facets(
        vertices.reshape(-1, 3), normals.reshape(-1, 3), _grid(len(outline), FACETS_AROUND_AXIS + 1)
    )


def _grid(rows: int, columns: int) -> Array:
    """Return the triangles of a grid of points that are numbered row by row, shape (m, 3)."""
    corner = np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)
    a, b, c, d = corner, corner + 1, corner + columns + 1, corner + columns
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _ball(core: tuple[float, float, float], radius: float) -> Facets:
    """Return the Minkowski sum of a box with half edges `core` and a ball; a box for radius 0.

    Each face is a grid on a cube, projected to the ball and moved to the corners of the core.
    """
    steps = np.tan(np.linspace(-math.pi / 4, math.pi / 4, 2 * (_ROWS_TO_POLE // 2) + 1))
    half = len(steps) // 2
    # the middle row is in both halves, since the face of the core lies between them
    steps = np.concatenate([steps[: half + 1], steps[half:]]) if radius else np.array([-1.0, 1.0])
    sides = np.repeat([-1.0, 1.0], len(steps) // 2)
    parts = [
        _face(np.array(core), radius, axis, sign, steps, sides)
        for axis in range(3)
        for sign in (-1.0, 1.0)
    ]
    return _joined(parts)


def _face(core: Array, radius: float, axis: int, sign: float, steps: Array, sides: Array) -> Facets:
    u, v = (axis + 1) % 3, (axis + 2) % 3
    normals = np.zeros((len(steps), len(steps), 3))
    normals[..., axis] = sign
    corners = normals.copy()
    corners[..., u], corners[..., v] = sides[None, :], sides[:, None]
    if radius:
        normals[..., u], normals[..., v] = steps[None, :], steps[:, None]
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    triangles = _grid(len(steps), len(steps))
    if sign < 0:
        triangles = triangles[:, ::-1]
    vertices = corners * core + radius * normals
    return Facets(vertices.reshape(-1, 3), normals.reshape(-1, 3), triangles)


def _joined(parts: list[Facets]) -> Facets:
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    return Facets(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
    )


def _flat(vertices: Array, faces: Array) -> Facets:
    """Return a polyhedron with flat faces: each has its own vertices and one normal."""
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    normals = np.repeat(across / np.where(lengths > 0, lengths, 1.0), 3, axis=0)
    return Facets(corners.reshape(-1, 3), normals, np.arange(3 * len(faces)).reshape(-1, 3))
