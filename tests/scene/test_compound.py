"""Capsules and rounded boxes in the engine: resting, rolling and turning as they should."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Link
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import Inertial, Sphere
from somo_cli.scene import compound, object_shapes
from tests.builders.rigid_objects import (
    PILL,
    ROUNDED_CUBE,
    SCALES,
    G,
    object_columns,
    scene_of_objects,
    slop,
)


@SCALES
def test_a_rounded_cube_rests_at_its_true_height(scale: float) -> None:
    cube = {**ROUNDED_CUBE, "position": [0, 0, 0.03]}
    found = object_columns(scene_of_objects(cube, ground={}, world_scale=scale), 0.5)["cube"]
    assert np.abs(found["z_m"] - 0.03).max() < slop(scale)
    assert np.hypot(found["x_m"], found["y_m"]).max() < 1e-8
    assert found["fz_n"][-1] == pytest.approx(0.1 * G, rel=1e-6)


@SCALES
def test_a_rounded_cube_on_edge_touches_with_its_edge(scale: float) -> None:
    # the middle is as high as half the diagonal of the core, and the radius
    height = 0.025 * math.sqrt(2) + 0.005
    cube = {**ROUNDED_CUBE, "position": [0, 0, height + 1e-4], "rpy": [math.pi / 4, 0, 0]}
    found = object_columns(scene_of_objects(cube, ground={}, world_scale=scale), 0.03)["cube"]
    assert found["z_m"][-1] == pytest.approx(height, abs=5 * slop(scale))


@SCALES
def test_a_rounded_cube_slides_as_coulomb_says(scale: float) -> None:
    cube = {
        **ROUNDED_CUBE,
        "position": [0, 0, 0.03],
        "linear_velocity": [0.5, 0, 0],
        "friction": 0.5,
    }
    found = object_columns(scene_of_objects(cube, ground={}, world_scale=scale), 0.3)["cube"]
    assert found["x_m"][-1] == pytest.approx(0.25 / (2 * 0.5 * G), rel=1e-2)


@SCALES
def test_a_capsule_lies_still_and_stands_still(scale: float) -> None:
    lying = {**PILL, "position": [0, 0, 0.01], "rpy": [math.pi / 2, 0, 0]}
    standing = {**PILL, "name": "other", "position": [1, 0, 0.04]}
    found = object_columns(scene_of_objects(lying, standing, ground={}, world_scale=scale), 1.0)
    assert np.abs(found["pill"]["z_m"] - 0.01).max() < slop(scale)
    assert np.hypot(found["pill"]["x_m"], found["pill"]["y_m"]).max() < 1e-8
    assert np.abs(found["other"]["z_m"] - 0.04).max() < max(slop(scale), 4e-6)


@SCALES
def test_a_capsule_rolls_on_as_it_was_set_rolling(scale: float) -> None:
    rolling = {
        **PILL,
        "position": [0, 0, 0.01],
        "rpy": [math.pi / 2, 0, 0],
        "linear_velocity": [0.2, 0, 0],
        "angular_velocity": [0, 20, 0],
    }
    found = object_columns(scene_of_objects(rolling, ground={}, world_scale=scale), 1.0)["pill"]
    assert found["x_m"][-1] == pytest.approx(0.2, rel=1e-6)
    assert np.abs(found["y_m"]).max() < 1e-6
    assert np.abs(found["z_m"] - 0.01).max() < slop(scale)


def test_a_capsule_rolls_down_a_slope_by_its_inertia() -> None:
    slope = 0.1  # rad
    lying = {**PILL, "friction": 1, "position": [0, 0, 0.01], "rpy": [math.pi / 2, 0, 0]}
    gravity = [G * math.sin(slope), 0, -G * math.cos(slope)]
    found = object_columns(scene_of_objects(lying, ground={}, gravity=gravity), 0.4)["pill"]
    inertial = object_shapes.object_link(PILL).inertial
    share = inertial.inertia[5] / (inertial.mass * 0.01**2)
    assert share == pytest.approx(0.4818, abs=1e-4)  # a cylinder has 0.5, a ball 0.4
    # it rolls 10 µm deep in the ground, on a radius of 0.1 % less
    ideal = G * math.sin(slope) / (1 + share) * found["t"] ** 2 / 2
    assert found["x_m"][-1] == pytest.approx(ideal[-1], rel=2e-3)


def test_density_is_mass_by_volume() -> None:
    link = object_shapes.object_link(PILL)
    assert link.inertial.mass == pytest.approx(
        1000 * (math.pi * 1e-4 * 0.06 + 4 / 3 * math.pi * 1e-6), rel=1e-12
    )
    assert isinstance(link.shapes[0].solid, Capsule)
    assert object_shapes.object_link({**PILL, "fixed": True}).inertial == link.inertial


def link_of(**data: Any) -> Link:
    return object_shapes.object_link({"mass": 1, **data})


def test_what_needs_no_compound() -> None:
    assert compound.is_exact_in_urdf(link_of(shape_type="box", dimensions=[1, 2, 3], edge_radius=0))
    assert not compound.is_exact_in_urdf(
        link_of(shape_type="box", dimensions=[1, 2, 3], edge_radius=0.1)
    )
    assert not compound.is_exact_in_urdf(link_of(shape_type="capsule", dimensions=[1, 2]))


def test_principal_axes_are_those_of_the_body() -> None:
    rotation = geometry.rotation_from_rpy((0.3, -0.5, 0.8))
    tensor = geometry.rotated_tensor((1.0, 0.0, 0.0, 2.0, 0.0, 2.5), rotation)
    axes, moments = compound.principal_axes(tensor)
    assert moments == pytest.approx((1, 2, 2.5))
    assert np.linalg.det(axes) == pytest.approx(1)
    six = (moments[0], 0.0, 0.0, moments[1], 0.0, moments[2])
    assert geometry.rotated_tensor(six, axes) == pytest.approx(tensor)
    assert compound.principal_axes((3.0, 0.0, 0.0, 2.0, 0.0, 1.0)) == (geometry.IDENTITY, (3, 2, 1))


def test_a_body_is_placed_by_its_centre_of_mass_and_its_axes() -> None:
    turn = geometry.rotation_from_rpy((0.3, -0.5, 0.8))
    inertia = geometry.rotated_tensor((1.0, 0.0, 0.0, 2.0, 0.0, 2.5), turn)
    shapes = (object_shapes.placed_shape(Sphere(0.1), (1, 2, 3)),)
    whole = compound.compound_of(Link("object", Inertial(2.0, (0.5, 0, 0), inertia), shapes))
    (ball,) = whole.shapes
    assert whole.frame.point(ball.position) == pytest.approx((1, 2, 3))
    assert whole.moments == pytest.approx((1, 2, 2.5))


def test_shapes_of_the_engine_are_counted() -> None:
    solid = [Sphere(1.0), Capsule(1.0, 1.0), RoundedBox((1.0, 1.0, 1.0), 0.1)]
    assert compound.shape_count(solid) == 5
    assert solid[1].height == 3
