"""Shells of a mesh: which is inside which, and what they enclose together."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.arrays import Array
from somo_cli.scene.closed_surface import outward_faces
from tests.builders.meshes import BOX_FACES, corners


def volume_of(*shells: tuple[Array, Array]) -> float:
    """Return the volume that shells, of vertices and faces each, enclose as one mesh."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in shells)])
    vertices = np.concatenate([vertices for vertices, _ in shells])
    faces = np.concatenate([own + start for (_, own), start in zip(shells, starts, strict=False)])
    a, b, c = np.moveaxis(vertices[outward_faces(vertices, faces)], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


FACES = np.array([part for a, b, c, d in BOX_FACES for part in ((a, b, c), (a, c, d))])
INVERTED = FACES[:, ::-1]
OUTER = corners((1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
INNER = corners((0.2, 0.2, 0.2), (0.1, 0.2, -0.1))


def test_an_inverted_shell_inside_another_is_a_cavity() -> None:
    assert volume_of((OUTER, FACES), (INNER, INVERTED)) == pytest.approx(1 - 0.008)
    assert volume_of((OUTER, INVERTED), (INNER, FACES)) == pytest.approx(1 - 0.008)


def test_an_inverted_shell_in_the_notch_of_another_is_a_body() -> None:
    # three bars around a notch, as one shell: a prism whose section is a U
    u = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
    vertices = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in u], dtype=float)
    flat = [(0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (0, 5, 6), (0, 6, 7)]
    below = [(a, c, b) for a, b, c in flat]
    above = [(a + 8, b + 8, c + 8) for a, b, c in flat]
    around = [((i + 1) % 8, i + 8, i) for i in range(8)]
    around += [((i + 1) % 8, (i + 1) % 8 + 8, i + 8) for i in range(8)]
    faces = np.array([*below, *above, *around])
    cube = corners((0.4, 0.4, 0.4), (1.5, 2.2, 0.5))  # within the box of the U, not within it
    assert volume_of((vertices, faces)) == pytest.approx(7)
    assert volume_of((vertices, faces), (cube, INVERTED)) == pytest.approx(7 + 0.064)
    inside = corners((0.4, 0.4, 0.4), (0.5, 2.2, 0.5))
    assert volume_of((vertices, faces), (inside, INVERTED)) == pytest.approx(7 - 0.064)
