"""Facets of solids: closed, turned outward, as large as what they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Sphere
from somo_cli.picture.facets import FACETS_AROUND_AXIS, Facets, facets

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0))
TETRAHEDRON = Hull(CORNERS, ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)))
ROUND = (
    math.sin(2 * math.pi / FACETS_AROUND_AXIS) * FACETS_AROUND_AXIS / (2 * math.pi)
)  # a polygon by its circle, in area


def volume(found: Facets) -> float:
    a, b, c = np.moveaxis(found.vertices[found.triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    ("solid", "wanted", "extent"),
    [
        (Box((1, 2, 3)), 6.0, (1, 2, 3)),
        (Cylinder(2, 0.5), math.pi / 2 * ROUND, (1, 1, 2)),
        (TETRAHEDRON, 1.0, (1, 2, 3)),
    ],
)
def test_what_is_flat_or_turned_is_exact(
    solid: AnySolid, wanted: float, extent: tuple[float, float, float]
) -> None:
    found = facets(solid)
    assert volume(found) == pytest.approx(wanted, rel=1e-12)
    assert np.ptp(found.vertices, axis=0) == pytest.approx(extent)


@pytest.mark.parametrize("solid", [Sphere(0.5), Capsule(1, 0.5), RoundedBox((1, 2, 3), 0.2)])
def test_what_is_round_is_a_little_smaller_than_it_is(
    solid: Sphere | Capsule | RoundedBox,
) -> None:
    found = facets(solid)
    assert 0.99 < volume(found) / solid.volume < 1
    # every vertex is on the surface, whose normal it has: a step along it leaves the solid
    if isinstance(solid, Sphere):
        assert found.normals * solid.radius == pytest.approx(found.vertices)


@pytest.mark.parametrize(
    "solid",
    [
        *(Box((1, 2, 3)), Cylinder(2, 0.5), Sphere(0.5), Capsule(1, 0.5), TETRAHEDRON),
        RoundedBox((1, 2, 3), 0.2),
    ],
)
def test_normals_are_of_unit_length_and_point_where_the_triangles_do(solid: AnySolid) -> None:
    found = facets(solid)
    assert np.linalg.norm(found.normals, axis=1) == pytest.approx(1)
    a, b, c = np.moveaxis(found.vertices[found.triangles], 1, 0)
    across = np.cross(b - a, c - a)
    area = np.linalg.norm(across, axis=1)
    is_real = area > 1e-12  # at the poles of a ball triangles shrink to lines
    mean = found.normals[found.triangles].mean(axis=1)
    cosine = np.einsum("ij,ij->i", across, mean)[is_real] / area[is_real]
    assert cosine.min() > 0.9


def test_a_box_without_round_edges_is_the_limit_of_one_that_has_them() -> None:
    nearly = facets(RoundedBox((1, 2, 3), 1e-9))
    assert volume(nearly) == pytest.approx(6, rel=1e-8)


def test_scaled_is_about_the_origin() -> None:
    found = facets(TETRAHEDRON)
    assert volume(found.scaled(2)) == pytest.approx(8 * volume(found))
