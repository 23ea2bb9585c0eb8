from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.geometry import Tensor
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import Box, Cylinder, Inertial, Solid, Sphere

SOLIDS = [Box((0.023, 0.017, 0.02)), Cylinder(0.03, 0.01), Sphere(0.015)]


def mesh_of(solid: Solid) -> trimesh.Trimesh:
    if isinstance(solid, Box):
        return trimesh.creation.box(solid.size)
    if isinstance(solid, Cylinder):
        return trimesh.creation.cylinder(solid.radius, solid.length, sections=720)
    return trimesh.creation.icosphere(6, solid.radius)


def full(tensor: Tensor) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = tensor
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def test_the_farthest_points_of_solids() -> None:
    box = Box((0.2, 0.4, 0.4))
    assert box.circumradius == pytest.approx(0.3)
    assert Cylinder(0.6, 0.4).circumradius == pytest.approx(0.5)
    assert Sphere(0.7).circumradius == 0.7
    assert Capsule(0.6, 0.4).circumradius == pytest.approx(0.7)
    assert RoundedBox(box.size, 0.0).circumradius == pytest.approx(0.3)
    # the ball in each corner, whose centre is at (0, 0.1, 0.1)
    assert RoundedBox(box.size, 0.1).circumradius == pytest.approx(0.1 + math.hypot(0.1, 0.1))
    corners = ((0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.0, 0.4, 0.3), (0.0, 0.0, 0.2))
    faces = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
    assert Hull(corners, faces).circumradius == pytest.approx(0.5)


def test_heights() -> None:
    assert [solid.height for solid in SOLIDS] == [0.02, 0.03, 0.03]


def test_halves() -> None:
    assert [solid.shortened(0.5) for solid in SOLIDS] == [
        Box((0.023, 0.017, 0.01)),
        Cylinder(0.015, 0.01),
        Sphere(0.0075),
    ]


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_half_is_half_as_high(solid: Solid) -> None:
    assert solid.shortened(0.5).height == solid.height / 2


@pytest.mark.parametrize("solid", SOLIDS)
def test_the_inertia_is_that_of_a_mesh(solid: Solid) -> None:
    mesh = mesh_of(solid)
    mesh.density = 0.1 / mesh.volume
    # a mesh lies inside what is round: by 1e-4 here
    tolerance = 1e-12 if isinstance(solid, Box) else 3e-4
    found = full(solid.inertia(0.1))
    assert np.allclose(found, mesh.moment_inertia, rtol=tolerance, atol=1e-12 * found.max())


@pytest.mark.parametrize("solid", SOLIDS)
def test_half_the_inertia_is_that_of_the_half_solid(solid: Solid) -> None:
    found = solids.shortened_inertia(solid, solid.inertia(0.1), 0.5)
    assert found == pytest.approx(solid.shortened(0.5).inertia(0.05), rel=1e-14)


def test_half_a_declared_inertia_is_that_of_the_squeezed_body() -> None:
    # eight points, in general position about their centre of mass
    points = np.array([(1, 2, 3), (-2, 1, 4), (3, -1, -2), (0, 2, -5)], float)
    points = np.concatenate([points, -points])

    def inertia(places: np.ndarray, mass: float) -> Tensor:
        parts = [Inertial(mass / 8, tuple(place), (0.0,) * 6) for place in places]
        return solids.lumped(tuple(parts)).inertia

    half = solids.shortened_inertia(SOLIDS[0], inertia(points, 1.6), 0.5)
    assert half == pytest.approx(inertia(points * [1, 1, 0.5], 0.8), rel=1e-14)
    half = solids.shortened_inertia(SOLIDS[2], inertia(points, 1.6), 0.5)
    assert half == pytest.approx(inertia(points * 0.5, 0.8), rel=1e-14)


def test_placing_moves_the_centre_and_turns_the_inertia() -> None:
    inertial = Inertial(2.0, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 2.0, 0.0, 3.0))
    quarter = geometry.rotation_from_rpy((0.0, 0.0, math.pi / 2))
    placed = solids.placed(inertial, (0.0, 0.0, 5.0), quarter)
    assert placed.mass == 2.0
    assert placed.centre == pytest.approx((0.0, 1.0, 5.0), abs=1e-15)
    assert placed.inertia == pytest.approx((2.0, 0.0, 0.0, 1.0, 0.0, 3.0), abs=1e-15)


def test_a_box_of_two_boxes() -> None:
    lower = Inertial(0.1, (0.0, 0.0, 0.01), Box((0.03, 0.02, 0.02)).inertia(0.1))
    upper = Inertial(0.2, (0.0, 0.0, 0.04), Box((0.03, 0.02, 0.04)).inertia(0.2))
    whole = solids.lumped((lower, upper))
    assert whole.mass == pytest.approx(0.3, rel=1e-15)
    assert whole.centre == pytest.approx((0.0, 0.0, 0.03), rel=1e-15)
    expected = Box((0.03, 0.02, 0.06)).inertia(0.3)
    assert whole.inertia == pytest.approx(expected, rel=1e-13, abs=1e-20)


def test_one_part_is_itself() -> None:
    part = Inertial(0.2, (0.1, 0.2, 0.3), (1.0, 0.1, 0.2, 2.0, 0.3, 2.5))
    assert solids.lumped((part,)).inertia == pytest.approx(part.inertia, rel=1e-15)


def test_lumping_turned_parts_is_that_of_their_meshes() -> None:
    box, other = Box((0.03, 0.02, 0.01)), Box((0.01, 0.05, 0.02))
    rpy, at = (0.4, -0.5, 0.6), (0.02, -0.03, 0.05)
    turned = geometry.rotation_from_rpy(rpy)
    part = Inertial(0.7, geometry.ZERO, other.inertia(0.7))
    base = Inertial(0.3, geometry.ZERO, box.inertia(0.3))
    whole = solids.lumped((base, solids.placed(part, at, turned)))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turned, at
    mesh, other_mesh = mesh_of(box), mesh_of(other)
    other_mesh.apply_transform(matrix)
    centre = (0.3 * mesh.center_mass + 0.7 * other_mesh.center_mass) / 1.0
    expected = np.zeros((3, 3))
    for one, mass in ((mesh, 0.3), (other_mesh, 0.7)):
        one.density = mass / one.volume
        r = one.center_mass - centre
        expected += one.moment_inertia + mass * (np.dot(r, r) * np.eye(3) - np.outer(r, r))
    assert np.allclose(whole.centre, centre, rtol=1e-12, atol=1e-15)
    assert np.allclose(full(whole.inertia), expected, rtol=1e-10, atol=1e-15)
