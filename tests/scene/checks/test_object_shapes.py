"""What is wrong with the shape and the mass of an object."""

from __future__ import annotations

import math

import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import object_shapes
from somo_cli.scene.extents import min_height
from tests.builders.definitions import Data
from tests.builders.meshes import corners, obj
from tests.builders.rigid_objects import PILL, ROUNDED_CUBE, object_problems


def test_valid_shapes_have_no_problems() -> None:
    assert object_problems(ROUNDED_CUBE, PILL) == []
    assert object_problems({**ROUNDED_CUBE, "fixed": True}, {**PILL, "fixed": True}) == []


@pytest.mark.parametrize(
    ("one_object", "message"),
    [
        ({**PILL, "dimensions": [1]}, "a capsule has 2 dimensions, found 1"),
        ({**PILL, "mass": 1}, "both mass and density are given"),
        ({**PILL, "edge_radius": 1}, "edge_radius is for shape_type box, and this one is capsule"),
        (
            {**ROUNDED_CUBE, "edge_radius": 0.03},
            "edge_radius 0.03 m is not less than half the shortest edge, 0.03 m",
        ),
        (
            {key: value for key, value in ROUNDED_CUBE.items() if key != "dimensions"},
            "a box needs dimensions",
        ),
        (
            {**ROUNDED_CUBE, "position": [0, 0, 0.02]},
            "object 'cube' starts 0.01 m inside the ground",
        ),
        ({**PILL, "position": [0, 0, 0.03]}, "object 'pill' starts 0.01 m inside the ground"),
    ],
)
def test_what_is_wrong(one_object: Data, message: str) -> None:
    assert object_problems(one_object, ground={}) == [message]


def test_a_mesh_in_the_ground() -> None:
    cube = {"source": "a.obj", "text": obj(corners((0.06, 0.06, 0.06), (0.1, 0.0, 0.03)))}
    mesh = {"name": "m", "shape_type": "mesh", "mesh": cube, "mass": 1}
    assert object_problems(mesh, ground={}) == []
    assert object_problems({**mesh, "position": [0, 0, -0.02]}, ground={}) == [
        "object 'm' starts 0.02 m inside the ground"
    ]
    # turned about the origin of its frame, it reaches as far down as it lay aside
    turned = {**mesh, "rpy": [0, math.pi / 2, 0]}
    assert object_problems(turned, ground={}) == ["object 'm' starts 0.13 m inside the ground"]
    assert object_problems({**turned, "fixed": True}, ground={}) == []


def test_a_urdf_in_the_ground() -> None:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="0.2"/></inertial>'
    low = '<collision><origin xyz="0 0 -1"/><geometry><sphere radius="0.5"/></geometry></collision>'
    high = low.replace("-1", "1")
    text = f'<robot><link name="a">{inertial}{high}{low}</link></robot>'
    data = {"name": "u", "shape_type": "urdf", "urdf": {"source": "a.urdf", "text": text}}
    assert object_problems({**data, "position": [0, 0, 1.5]}, ground={}) == []
    assert object_problems(data, ground={}) == ["object 'u' starts 1.5 m inside the ground"]


def test_more_shapes_than_the_engine_takes_beside_meshes() -> None:
    pill = '<collision><geometry><capsule length="1" radius="1"/></geometry></collision>'
    mesh = '<collision><geometry><mesh filename="cube.obj"/></geometry></collision>'
    text = f'<robot><link name="a">{6 * pill}{{}}</link></robot>'
    file = {"source": "a.urdf", "text": text.format("")}
    fixed = {"name": "u", "shape_type": "urdf", "fixed": True}
    assert object_problems({**fixed, "urdf": file}) == []
    cube = {"source": "cube.obj", "text": obj(corners((1.0, 1.0, 1.0), (0.0, 0.0, 0.0)))}
    file = {"source": "a.urdf", "text": text.format(mesh), "meshes": [cube]}
    assert object_problems({**fixed, "urdf": file}) == [
        "the object has meshes and 18 other shapes, and the engine takes at most 15 beside meshes; "
        "a capsule counts as three"
    ]


def test_a_body_that_resists_no_turn() -> None:
    inertial = '<inertial><mass value="1"/><inertia ixx="0" iyy="0" izz="0"/></inertial>'
    ball = '<collision><geometry><sphere radius="1"/></geometry></collision>'
    text = f'<robot><link name="a">{inertial}{ball}</link></robot>'
    data = {"name": "u", "shape_type": "urdf", "urdf": {"source": "a.urdf", "text": text}}
    assert object_problems(data) == [
        "the principal moments of inertia of the object are 0, 0 and 0 kg·m²"
    ]
    frame = {**data, "urdf": {"source": "a.urdf", "text": text.replace('"1"/><in', '"0"/><in')}}
    assert object_problems(frame) == ["no link has a mass"]


def test_the_lowest_point_of_what_is_round() -> None:
    tilted = geometry.rotation_from_rpy((0.7, 0.4, 0.2))
    for one_object in (PILL, ROUNDED_CUBE):
        (shape,) = object_shapes.object_link(one_object).shapes
        below = min_height(shape, Pose((0.0, 0.0, 1.0), tilted))
        x, y, z = tilted[2]
        if one_object is PILL:
            assert below == pytest.approx(1 - 0.03 * abs(z) - 0.01)
        else:
            assert below == pytest.approx(1 - 0.025 * (abs(x) + abs(y) + abs(z)) - 0.005)
