"""Meshes and URDFs in the engine: at their true height, with their true inertia, in their frame."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import numpy as np
import pytest
import scipy.integrate

from somo_cli.manipulator import geometry
from somo_cli.scene import columns, object_shapes
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import Data
from tests.builders.meshes import corners, obj
from tests.builders.rigid_objects import SCALES, G, object_columns, scene_of_objects, slop
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

SIZE = (0.06, 0.06, 0.06)


def mesh_of(vertices: np.ndarray, name: str = "mesh", **more: Any) -> Data:
    file = {"source": f"{name}.obj", "text": obj(vertices)}
    return {"name": name, "shape_type": "mesh", "mesh": file, "mass": 0.1, **more}


CUBE = mesh_of(corners(SIZE, geometry.ZERO))


@SCALES
def test_a_mesh_rests_at_its_true_height(scale: float) -> None:
    found = object_columns(
        scene_of_objects({**CUBE, "position": [0, 0, 0.03]}, ground={}, world_scale=scale), 0.5
    )
    assert np.abs(found["mesh"]["z_m"] - 0.03).max() < slop(scale) + 2e-9
    assert np.hypot(found["mesh"]["x_m"], found["mesh"]["y_m"]).max() < 1e-8
    assert found["mesh"]["fz_n"][-1] == pytest.approx(0.1 * G, rel=1e-6)


@SCALES
def test_the_position_is_that_of_the_frame_of_the_file(scale: float) -> None:
    aside = mesh_of(corners(SIZE, (0.1, 0.0, 0.03)), position=[1, 0, 0])
    found = object_columns(scene_of_objects(aside, ground={}, world_scale=scale), 0.5)["mesh"]
    assert np.abs(found["z_m"]).max() < slop(scale) + 2e-9
    assert np.abs(found["x_m"] - 1).max() < 1e-8


@SCALES
def test_parts_side_by_side_rest_as_one(scale: float) -> None:
    one = corners((0.06, 0.03, 0.06), (0.0, -0.015, 0.0))
    other = corners((0.06, 0.03, 0.06), (0.0, 0.015, 0.0))
    files = [{"source": f"{n}.obj", "text": obj(part)} for n, part in enumerate((one, other))]
    pair = {**CUBE, "mesh": files, "position": [0, 0, 0.03]}
    whole, parts = (
        object_shapes.object_link(CUBE).inertial,
        object_shapes.object_link(pair).inertial,
    )
    assert parts.mass == whole.mass
    assert parts.centre == pytest.approx(whole.centre, abs=1e-12)
    assert parts.inertia == pytest.approx(whole.inertia, abs=1e-12)
    found = object_columns(scene_of_objects(pair, ground={}, world_scale=scale), 0.5)["mesh"]
    assert np.abs(found["z_m"] - 0.03).max() < slop(scale) + 2e-8


@SCALES
def test_a_mesh_slides_as_coulomb_says(scale: float) -> None:
    cube = {**CUBE, "position": [0, 0, 0.03], "linear_velocity": [0.5, 0, 0], "friction": 0.5}
    found = object_columns(scene_of_objects(cube, ground={}, world_scale=scale), 0.3)["mesh"]
    assert found["x_m"][-1] == pytest.approx(0.25 / (2 * 0.5 * G), rel=1e-2)


@SCALES
def test_a_cube_falls_over_its_edge_by_its_inertia(scale: float) -> None:
    a, start = 0.06, 0.2  # m; rad beyond the point of balance
    tilted = {**CUBE, "rpy": [math.pi / 4 + start, 0, 0], "friction": 1}
    tilted["position"] = [0, 0, a / math.sqrt(2) * math.cos(start)]
    scene = scene_of_objects(tilted, ground={}, world_scale=scale, time_step=2.5e-4)
    scene["record"]["every"] = 4
    found = object_columns(scene, 0.15)["mesh"]
    angle = 2 * np.arctan2(found["qx"], found["qw"]) - math.pi / 4
    # about the edge: 2/3 m a² θ'' = m g a/√2 sin θ
    rate = G / math.sqrt(2) / (2 / 3 * a)
    t = found["t"]
    swing = scipy.integrate.solve_ivp(
        lambda _, y: (y[1], rate * math.sin(y[0])), (0, t[-1]), (start, 0), t_eval=t, rtol=1e-9
    ).y[0]
    assert swing[-1] > 0.5
    assert angle == pytest.approx(swing, abs=4e-3)


def test_a_free_body_turns_as_euler_says_whatever_its_frame() -> None:
    size, mass = (0.06, 0.04, 0.02), 0.1
    spin = np.array([3.0, 0.2, 4.0])  # rad/s, in the world
    turn = geometry.rotation_from_rpy((0.4, -0.7, 1.1))
    # the box lies turned and aside in its file; the object's turn brings it back to the axes
    aside = (0.05, -0.02, 0.03)
    placed = corners(size, geometry.ZERO) @ np.array(turn).T + aside
    back = geometry.transposed(turn)
    data = mesh_of(placed, "turned", linear_velocity=[0.1, 0, 0], angular_velocity=spin.tolist())
    data["rpy"] = list(geometry.rpy_from_rotation(back))
    plain: Data = {"name": "plain", "shape_type": "box", "dimensions": list(size), "mass": mass}
    plain |= {"linear_velocity": [0.1, 0, 0], "angular_velocity": spin.tolist()}
    plain["position"] = [0, 1, 0]
    scene = scene_of_objects(data, plain, gravity=[0, 0, 0], time_step=2.5e-4)
    scene["record"]["every"] = 40
    found = object_columns(scene, 0.5)

    t = found["plain"]["t"]
    axes = {name: orientations(found[name]) for name in found}
    of_box = axes["turned"] @ np.array(turn)
    assert of_box == pytest.approx(axes["plain"], abs=1e-8)
    # the centre of mass goes straight on
    centre = np.stack([found["turned"][x] for x in ("x_m", "y_m", "z_m")], axis=1)
    centre += axes["turned"] @ np.array(aside)
    started = np.array(back) @ np.array(aside)
    assert centre[:, 0] == pytest.approx(started[0] + 0.1 * t, abs=1e-9)
    assert centre[:, 1:] == pytest.approx(np.tile(started[1:], (len(t), 1)), abs=1e-9)
    assert of_box[-1] == pytest.approx(turned_by_euler(size, mass, spin, t[-1]), abs=3e-3)


def orientations(columns: dict[str, np.ndarray]) -> np.ndarray:
    turns = zip(*(columns[q] for q in ("qx", "qy", "qz", "qw")), strict=True)
    return np.array([geometry.rotation_from_quaternion(one) for one in turns])


def turned_by_euler(size: Any, mass: float, spin: np.ndarray, time: float) -> np.ndarray:
    """Return the orientation of a free box after a time, by Euler's equations."""
    squares = np.array(size) ** 2
    moments = mass * (squares.sum() - squares) / 12

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        own, axes = y[:3], y[3:].reshape(3, 3)
        x, yy, z = own
        cross = np.array([[0, -z, yy], [z, 0, -x], [-yy, x, 0]])
        turning = np.cross(moments * own, own) / moments
        return np.concatenate([turning, (axes @ cross).ravel()])

    start = np.concatenate([spin, np.eye(3).ravel()])
    end = scipy.integrate.solve_ivp(rates, (0, time), start, rtol=1e-10, atol=1e-12).y[:, -1]
    return end[3:].reshape(3, 3)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["rounded", "mesh", "parts"])
def test_a_finger_pushes_it_as_far_as_the_box(kind: str) -> None:
    pytest.importorskip("pybullet")
    scene = scene_from_file("push_scene.yaml")
    box = scene.objects[0]
    edges = (0.04, 0.04, 0.04)
    halves = [corners((0.04, 0.02, 0.04), (0.0, y, 0.0)) for y in (-0.01, 0.01)]
    parts = [{"source": "a.obj", "text": obj(half)} for half in halves]
    made: dict[str, Data] = {
        "rounded": {"shape_type": "box", "dimensions": list(edges), "edge_radius": 0.002},
        "mesh": mesh_of(corners(edges, geometry.ZERO)),
        "parts": {"shape_type": "mesh", "mesh": parts},
    }
    link = object_shapes.object_link({**made[kind], "mass": 0.01})
    other = dataclasses.replace(box, chain=dataclasses.replace(box.chain, links=(link,)))
    ends = []
    for body in (box, other):
        plan = make_plan(dataclasses.replace(scene, objects=(body,)))
        row = dict(zip(columns.header(plan.recorded), rows_of(plan, 2000)[-1], strict=True))
        ends.append(row["cube.pose.y_m"])
    assert ends[0] > 0.07
    assert ends[1] == pytest.approx(ends[0], abs=1e-4)


def test_the_same_scene_gives_the_same_rows() -> None:
    data = scene_of_objects({**CUBE, "position": [0, 0, 0.05], "rpy": [0.3, 0.2, 0.1]}, ground={})
    first, second = (object_columns(json.loads(json.dumps(data)), 0.3)["mesh"] for _ in range(2))
    assert all((first[name] == second[name]).all() for name in first)


def test_a_urdf_body_stands_on_its_lowest_shape() -> None:
    text = """<robot name="r"><link name="a">
      <inertial><origin xyz="0 0 0.01"/><mass value="0.2"/>
        <inertia ixx="1e-4" iyy="2e-4" izz="2.5e-4" ixy="2e-5"/></inertial>
      <collision><geometry><box size="0.1 0.1 0.02"/></geometry></collision>
      <collision><origin xyz="0 0 0.05"/>
        <geometry><cylinder length="0.08" radius="0.01"/></geometry></collision>
    </link></robot>"""
    data = {"name": "u", "shape_type": "urdf", "urdf": {"source": "r.urdf", "text": text}}
    data["position"] = [0, 0, 0.01]
    found = object_columns(scene_of_objects(data, ground={}, world_scale=20), 0.5)["u"]
    assert np.abs(found["z_m"] - 0.01).max() < 4e-6
    assert found["z_m"][-1] == pytest.approx(0.01, abs=slop(20))
    assert found["fz_n"][-1] == pytest.approx(0.2 * G, rel=1e-6)
    assert object_shapes.object_link(data).inertial.centre == (0, 0, 0.01)
    # upside down it stands on the end of the cylinder
    scene = scene_from_text(json.dumps(scene_of_objects({**data, "rpy": [math.pi, 0, 0]})))
    assert len(scene.objects[0].chain.links[0].shapes) == 2
