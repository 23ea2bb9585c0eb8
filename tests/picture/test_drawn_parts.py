"""What is drawn of a scene, and where: the parts stand where the columns say the links are."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.manipulator.solids import Box
from somo_cli.picture.drawn_parts import framed_points, parts_of, poses_at, start_configuration
from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file

SCENES = ["hand_scene.yaml", "tumble_scene.yaml", "starfish_scene.yaml"]


@pytest.mark.parametrize("name", SCENES)
def test_every_shape_of_a_scene_is_a_part(name: str) -> None:
    scene = scene_from_file(name)
    links = [one.compiled.chain.links for one in scene.manipulators]
    links += [one.chain.links for one in scene.objects]
    wanted = [
        (body, link, shape.material.rgba[:3])
        for body, own in enumerate(links)
        for link, of_link in enumerate(own)
        for shape in of_link.shapes
    ]
    assert [(one.body, one.link, one.colour) for one in parts_of(scene)] == wanted


@pytest.mark.parametrize("name", SCENES)
def test_the_start_is_where_the_first_row_has_the_links(name: str) -> None:
    pytest.importorskip("pybullet")
    scene = scene_from_file(name)
    recorded = dataclasses.replace(
        scene, columns=("link_positions",), object_quantities=("pose",), only=()
    )
    (row,) = rows_of(recorded, 0)
    reported = dict(zip(columns.header(make_plan(recorded).recorded), row, strict=True))
    parts = parts_of(scene)
    for part, pose in zip(parts, poses_at(scene, parts, start_configuration(scene)), strict=True):
        if part.body < len(scene.manipulators):
            one = scene.manipulators[part.body]
            owner = f"{one.name}.{one.compiled.chain.links[part.link].name}"
        else:
            owner = f"{scene.objects[part.body - len(scene.manipulators)].name}.pose"
        link = [reported[f"{owner}.{axis}_m"] for axis in "xyz"]
        # the part may stand off from its link, in whatever direction that is turned
        off = np.linalg.norm(np.array(pose.position) - link)
        assert off == pytest.approx(np.linalg.norm(part.pose.position), abs=1e-9)


def test_a_fixed_object_is_drawn_and_not_framed() -> None:
    scene = scene_from_file("push_scene.yaml")
    assert all(part.is_framed for part in parts_of(scene))
    held = dataclasses.replace(
        scene, objects=tuple(dataclasses.replace(one, is_fixed=True) for one in scene.objects)
    )
    assert [part.is_framed for part in parts_of(held)] == [
        part.body < len(scene.manipulators) for part in parts_of(scene)
    ]


def test_framed_points_are_the_corners_of_what_is_framed() -> None:
    scene = scene_from_file("push_scene.yaml")
    parts = parts_of(scene)[-1:]
    (one_object,) = scene.objects
    (shape,) = one_object.chain.links[0].shapes
    assert isinstance(shape.solid, Box)
    points = framed_points(parts, poses_at(scene, parts, start_configuration(scene)))
    middle = start_configuration(scene).objects[0].position
    assert points.shape == (8, 3)
    assert np.abs(points - middle) == pytest.approx(np.tile(np.array(shape.solid.size) / 2, (8, 1)))
