"""Meshes as text and bytes of files."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.manipulator.geometry import Vector

Faces = Sequence[Sequence[int]]

# a box of six quads, seen from outside
BOX_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def corners(size: Vector, centre: Vector) -> np.ndarray:
    """Return the corners of a box along the axes, shape (8, 3), in the order of BOX_FACES."""
    signs = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    return np.array(signs) * np.array(size) / 2 + np.array(centre)


def obj(vertices: np.ndarray, faces: Faces = BOX_FACES) -> str:
    """Return the text of an OBJ file."""
    lines = ["v " + " ".join(repr(float(x)) for x in row) for row in vertices]
    return "\n".join([*lines, *("f " + " ".join(str(1 + i) for i in f) for f in faces)])


def binary_stl(vertices: np.ndarray) -> bytes:
    """Return the content of a binary STL file of a box with these corners."""
    triangles = [(a, b, c) for a, b, c, _ in BOX_FACES] + [(a, c, d) for a, _, c, d in BOX_FACES]
    record = np.zeros(12, np.dtype([("n", "<3f4"), ("p", "<9f4"), ("a", "<u2")]))
    record["p"] = vertices[np.array(triangles)].reshape(12, 9)
    return b"\xe9" * 80 + np.uint32(12).tobytes() + record.tobytes()


BOX_SIZE, BOX_CENTRE = (0.06, 0.04, 0.02), (0.1, 0.2, 0.3)

BOX_CORNERS = corners(BOX_SIZE, BOX_CENTRE)
