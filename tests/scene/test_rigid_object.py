"""Objects, fixed and free: falling, sliding, stacking, colliding, and what is wrong with them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import Data
from tests.builders.rigid_objects import (
    BALL,
    CUBE,
    G,
    object_columns,
    object_problems,
    scene_of_objects,
)
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text


@pytest.mark.parametrize("step", [5e-4, 4e-3])
@pytest.mark.parametrize("one_object", [CUBE, BALL])
def test_what_falls_falls_as_galileo_says(one_object: Data, step: float) -> None:
    data = scene_of_objects(
        {**one_object, "position": [0, 0, 1], "linear_velocity": [0.3, 0, 1]}, time_step=step
    )
    (found,) = object_columns(data, 0.4).values()
    # of second order, and for a parabola that is exact
    t = found["t"]
    assert found["z_m"] == pytest.approx(1 + t - G * t**2 / 2, abs=1e-9)
    assert found["x_m"] == pytest.approx(0.3 * t, abs=1e-9)
    assert not found["normal_n"].any()


@pytest.mark.parametrize("step", [5e-4, 2e-3])
def test_friction_stops_a_cube(step: float) -> None:
    data = scene_of_objects({**CUBE, "linear_velocity": [0.5, 0, 0]}, ground={}, time_step=step)
    cube = object_columns(data, 0.5)["cube"]
    assert cube["x_m"][-1] == pytest.approx(0.25 / (2 * 0.5 * G), rel=2e-4)
    assert cube["z_m"] == pytest.approx(0.02, abs=1e-5)
    assert cube["fz_n"][-1] == pytest.approx(0.01 * G, rel=1e-6)


@pytest.mark.moderate
def test_a_stack_stays() -> None:
    stack = [{**CUBE, "name": f"cube_{n}", "position": [0, 0, 0.02 + 0.04 * n]} for n in range(4)]
    found = object_columns(scene_of_objects(*stack, ground={}), 2.0)
    for n in range(4):
        one = found[f"cube_{n}"]
        assert one["z_m"][-1] == pytest.approx(0.02 + 0.04 * n, abs=1e-4)
        assert np.hypot(one["x_m"], one["y_m"]).max() < 1e-3
        # what it carries, and itself
        assert one["normal_n"][-1] == pytest.approx((2 * (4 - n) - 1) * 0.01 * G, rel=1e-3)


def test_a_collision_keeps_momentum_and_makes_no_energy() -> None:
    one = {**CUBE, "name": "one", "position": [0, 0, 0], "linear_velocity": [1, 0, 0]}
    other = {**CUBE, "name": "other", "position": [0.1, 0.003, 0.002], "mass": 0.03}
    found = object_columns(scene_of_objects(one, other, gravity=[0, 0, 0]), 0.3)
    for axis in ("x_m", "y_m", "z_m"):
        centre = 0.01 * found["one"][axis] + 0.03 * found["other"][axis]
        rates = np.diff(centre) / np.diff(found["one"]["t"])
        assert rates == pytest.approx(0.01 if axis == "x_m" else 0, abs=1e-9)
    speeds = [np.diff(found[name]["x_m"])[-1] / np.diff(found[name]["t"])[-1] for name in found]
    assert 0.005 * speeds[0] ** 2 + 0.015 * speeds[1] ** 2 <= 0.005


def test_a_fixed_object_stays_and_holds() -> None:
    table = {**CUBE, "name": "table", "fixed": True, "position": [0, 0, -0.02]}
    del table["mass"]
    found = object_columns(scene_of_objects(table, {**CUBE, "position": [0.01, 0, 0.02]}), 0.5)
    assert not np.ptp(found["table"]["z_m"])
    assert found["cube"]["z_m"][-1] == pytest.approx(0.02, abs=1e-5)
    assert found["table"]["fz_n"][-1] == pytest.approx(-0.01 * G, rel=1e-6)


def test_a_cylinder_lies_along_its_z_axis() -> None:
    pipe = {"name": "pipe", "shape_type": "cylinder", "dimensions": [0.1, 0.01], "mass": 0.02}
    lying = {**pipe, "position": [0, 0, 0.01], "rpy": [math.pi / 2, 0, 0]}
    assert object_columns(scene_of_objects(lying, ground={}), 0.3)["pipe"]["z_m"][
        -1
    ] == pytest.approx(0.01, abs=1e-4)
    standing = {**pipe, "position": [0, 0, 0.05]}
    assert object_columns(scene_of_objects(standing, ground={}), 0.3)["pipe"]["z_m"][
        -1
    ] == pytest.approx(0.05, abs=1e-4)


@pytest.mark.slow
def test_a_finger_pushes_a_cube_alike_at_every_step() -> None:
    pytest.importorskip("pybullet")
    ends = []
    for step in (1e-3, 2e-3, 4e-3):
        scene = scene_from_file("push_scene.yaml", f"time_step={step}")
        rows = np.array(rows_of(scene, round(2 / step)))
        names = columns.header(make_plan(scene).recorded)
        ends.append(rows[-1, names.index("cube.pose.y_m")])
    assert ends[0] > 0.06
    assert ends == pytest.approx([ends[0]] * 3, abs=1e-3)


def test_the_world_scale_is_never_seen() -> None:
    ends = []
    for scale in (1, 20):
        data = scene_of_objects(
            {**CUBE, "linear_velocity": [0.5, 0, 0]}, ground={}, world_scale=scale
        )
        ends.append(object_columns(data, 0.3)["cube"]["x_m"][-1])
    assert ends[0] == pytest.approx(ends[1], rel=2e-3)


def test_what_is_wrong_with_objects() -> None:
    assert object_problems(CUBE, BALL, ground={"height": -1}) == []
    light = {key: value for key, value in CUBE.items() if key != "mass"}
    assert object_problems(light) == ["a free object needs a mass"]
    assert object_problems({**light, "fixed": True}) == []
    assert object_problems({**CUBE, "fixed": True, "linear_velocity": [1, 0, 0]}) == [
        "linear_velocity is for a free object, and this one is fixed"
    ]
    assert object_problems({**CUBE, "dimensions": [1, 2]}) == ["a box has 3 dimensions, found 2"]
    assert object_problems({**BALL, "dimensions": [1, 2]}) == ["a sphere has 1 dimensions, found 2"]
    assert object_problems(CUBE, CUBE) == ["another manipulator or object is called 'cube'"]
    assert object_problems({**CUBE, "name": "body"}) == [
        "another manipulator or object is called 'body'"
    ]
    assert object_problems({**CUBE, "position": [0, 0, 0]}, ground={}) == [
        "object 'cube' starts 0.02 m inside the ground"
    ]


def test_a_colour_is_that_of_every_shape_and_changes_no_byte_of_what_the_engine_is_given() -> None:
    plain, painted = (
        scene_from_text(json.dumps(scene_of_objects({**CUBE, **colour})))
        for colour in ({}, {"material_color": [0.1, 0.2, 0.3, 1]})
    )
    (shape,) = painted.objects[0].chain.links[0].shapes
    assert shape.material.rgba == (0.1, 0.2, 0.3, 1.0)
    assert make_plan(painted).objects[0].urdf == make_plan(plain).objects[0].urdf
