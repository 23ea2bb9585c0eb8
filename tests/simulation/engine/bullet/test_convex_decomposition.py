"""Convex pieces of a mesh by V-HACD: where the mesh is, whatever its size and place."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.engine.bullet.convex_decomposition import convex_pieces
from tests.builders.meshes import BOX_FACES, corners, obj

pytest.importorskip("pybullet")

TRIANGLES = [triangle for a, b, c, d in BOX_FACES for triangle in ((a, b, c), (a, c, d))]


@pytest.mark.parametrize("scale", [1e-3, 1.0])
def test_a_box_is_one_piece_in_its_place(scale: float) -> None:
    # the library writes six decimals, so it must be given a mesh of unit size
    box = scale * corners((0.06, 0.04, 0.02), (0.1, 0.2, 0.3))
    text = convex_pieces(obj(box, TRIANGLES))
    assert text is not None
    lines = text.splitlines()
    points = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
    assert sum(line.startswith("o ") for line in lines) == 1
    # V-HACD keeps a convex mesh but for its voxels, of which there are 100,000
    for bound in (np.min, np.max):
        assert bound(points, axis=0) == pytest.approx(bound(box, axis=0), abs=5e-4 * scale)
