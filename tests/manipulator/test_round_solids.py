"""Capsule and rounded box: closed forms against fine meshes, and in their limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import Box, Sphere

CAPSULE = Capsule(0.06, 0.02)
ROUNDED = RoundedBox((0.06, 0.05, 0.03), 0.008)


def mesh_of(solid: Capsule | RoundedBox) -> trimesh.Trimesh:
    ball = trimesh.creation.icosphere(5, solid.radius).vertices
    if isinstance(solid, Capsule):
        centres = [(0, 0, -solid.length / 2), (0, 0, solid.length / 2)]
    else:
        a, b, c = solid.core
        centres = [(x, y, z) for x in (-a, a) for y in (-b, b) for z in (-c, c)]
    return trimesh.convex.convex_hull(np.concatenate([ball + centre for centre in centres]))


@pytest.mark.parametrize("solid", [CAPSULE, ROUNDED])
def test_volume_and_inertia_are_those_of_a_mesh(solid: Capsule | RoundedBox) -> None:
    mesh = mesh_of(solid)
    assert solid.volume == pytest.approx(mesh.volume, rel=2e-3)
    mesh.density = 0.3 / mesh.volume
    xx, xy, xz, yy, yz, zz = solid.inertia(0.3)
    found = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    assert np.allclose(found, mesh.moment_inertia, rtol=2e-3, atol=1e-6 * xx)
    # a mesh lies inside what is round, so it cannot be the larger one
    assert solid.volume > mesh.volume


def test_a_capsule_without_length_is_a_ball() -> None:
    found = Capsule(1e-12, 0.02).inertia(0.3)
    assert found == pytest.approx(Sphere(0.02).inertia(0.3), rel=1e-9)
    assert Capsule(1e-12, 0.02).volume == pytest.approx(Sphere(0.02).volume, rel=1e-9)


def test_a_rounded_box_is_between_a_box_and_a_ball() -> None:
    size = (0.06, 0.05, 0.03)
    sharp = RoundedBox(size, 1e-12)
    assert sharp.inertia(0.3) == pytest.approx(Box(size).inertia(0.3), rel=1e-9)
    assert sharp.volume == pytest.approx(math.prod(size), rel=1e-9)
    ball = RoundedBox((0.06, 0.06, 0.06), 0.03)
    assert ball.inertia(0.3) == pytest.approx(Sphere(0.03).inertia(0.3), rel=1e-12)
    assert ball.volume == pytest.approx(Sphere(0.03).volume, rel=1e-12)


def test_heights() -> None:
    assert CAPSULE.height == 0.1
    assert ROUNDED.height == 0.03
