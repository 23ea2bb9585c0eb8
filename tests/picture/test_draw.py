"""Pictures of shipped scenes: everything is in them, and their shadows lie where they must."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from somo_cli.picture import shading, shadows
from somo_cli.picture.camera import VIEWS, Camera, framing
from somo_cli.picture.draw import PictureSettings, pictures, tile_edge
from somo_cli.picture.drawn_parts import framed_points, parts_of, poses_at
from somo_cli.picture.facets import Array
from somo_cli.picture.recorded_motion import RecordedMotion, scene_to_draw
from somo_cli.picture.tiny_renderer import TinyRenderer
from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.projection import project
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

pytest.importorskip("pybullet")

SMALL = (160, 120)
SCENES = [
    *("scene.yaml", "hand_scene.yaml", "starfish_scene.yaml", "snake_scene.yaml"),
    *("lift_scene.yaml", "tumble_scene.yaml", "crawler_scene.yaml", "three_axis_finger_scene.yaml"),
]
BALL = """
ground: {}
manipulators:
  - {definition: finger.yaml, position: [0, 0, 0]}
objects:
  - {name: ball, shape_type: sphere, dimensions: [0.02], fixed: true, position: [0.1, -0.02, 0.1]}
"""


def recording(name: str, time: float) -> RecordedMotion:
    scene = scene_to_draw(scene_from_file(name))
    steps = round(time / scene.time_step)
    scene = dataclasses.replace(scene, every=max(steps, 1))
    names = columns.header(make_plan(scene).recorded)
    return RecordedMotion(
        scene, dict(zip(names, zip(*rows_of(scene, steps), strict=True), strict=True))
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_everything_that_can_be_seen_is_in_the_picture_and_nothing_at_its_edge(name: str) -> None:
    motion = recording(name, 0.05)
    parts = parts_of(motion.scene)
    poses = poses_at(motion.scene, parts, motion.at(0.05))
    camera = framing(framed_points(parts, poses), VIEWS["oblique"], (640, 480))
    with TinyRenderer(parts, 1.0) as renderer:
        renderer.place(poses)
        raster = renderer.render(camera, (640, 480), shadows.light_direction(camera))
    seen = {(parts[one].body, parts[one].link) for one in np.unique(raster.parts) if one >= 0}
    bodies = {part.body for part in parts}
    assert {body for body, _ in seen} == bodies
    # a link may be hidden by others, as those in the hand, but not many are
    assert len(seen) >= 0.8 * len({(part.body, part.link) for part in parts})
    edge = np.concatenate([raster.parts[[0, -1]].ravel(), raster.parts[:, [0, -1]].ravel()])
    assert (edge < 0).all()


@pytest.mark.slow
def test_a_picture_of_a_moment_is_the_same_every_time_and_not_that_of_another() -> None:
    motion = recording("lift_scene.yaml", 0.5)
    settings = PictureSettings(VIEWS["oblique"], SMALL)
    first, again = next(pictures(motion, [0.5], settings)), next(pictures(motion, [0.5], settings))
    assert first.shape == (120, 160, 3)
    assert first.dtype == np.uint8
    assert np.array_equal(first, again)
    assert not np.array_equal(first, next(pictures(motion, [0.0], settings)))


@pytest.mark.slow
def test_one_camera_takes_all_pictures_of_a_film() -> None:
    motion = recording("lift_scene.yaml", 1.2)
    first, last = pictures(motion, [0.0, 1.2], PictureSettings(VIEWS["oblique"], SMALL))
    # the corner of the ground nearest to the camera has nothing on it, and does not move
    assert np.array_equal(first[-20:, -20:], last[-20:, -20:])
    assert not np.array_equal(first, last)


def test_a_body_throws_its_shadow_away_from_the_light() -> None:
    scene = scene_from_text(BALL)
    motion = RecordedMotion(scene_to_draw(scene), _still(scene.manipulators[0].compiled.chain))
    parts = parts_of(scene)
    poses = poses_at(scene, parts, motion.at(0.0))
    points = framed_points(parts, poses)
    everything = np.concatenate([points, [[0.2, 0.1, 0], [0.1, -0.02, 0.1]]])
    camera = framing(everything, VIEWS["top"], (400, 400))
    light = shadows.light_direction(camera)
    dark = _dark(camera, parts, poses, shadows.lamp(everything, light), light)
    ball = np.array([0.1, -0.02, 0.1])
    distance = ball[2] / light[2]
    beneath = ball - distance * light
    spots = {
        "beneath the ball, along the light": (beneath, 1.0),
        "to one side": (beneath + np.array([0.03, 0, 0]), 0.0),
        "straight below": ((0.1, -0.02, 0.0), 0.0),
    }
    assert math.hypot(light[0], light[1]) * distance > 0.025, "or the shadow lies straight below"
    for what, (spot, wanted) in spots.items():
        column, row = _pixel(camera, np.array(spot), 400)
        assert dark[row, column] == wanted, what


def test_the_ground_is_in_squares_where_there_is_one() -> None:
    scene = scene_from_text(BALL)
    still = _still(scene.manipulators[0].compiled.chain)
    assert tile_edge(RecordedMotion(scene, still), [0.0]) == pytest.approx(0.02)
    bare = dataclasses.replace(scene, ground=None)
    assert tile_edge(RecordedMotion(bare, still), [0.0]) is None
    (with_ground,) = pictures(
        RecordedMotion(scene, still), [0.0], PictureSettings(VIEWS["oblique"], SMALL)
    )
    (without,) = pictures(
        RecordedMotion(bare, still), [0.0], PictureSettings(VIEWS["oblique"], SMALL)
    )
    assert (without[-1] == 255).all()
    greys = set(np.unique(with_ground[-1]).tolist())
    assert {round(tile) for tile in shading.TILES} <= greys


def _still(chain: object) -> dict[str, tuple[float, ...]]:
    joints = chain.joints  # type: ignore[attr-defined]
    return {"time_s": (0.0,)} | {f"finger.{joint.name}.angle_rad": (0.0,) for joint in joints}


def _pixel(camera: Camera, point: Array, size: int) -> tuple[int, int]:
    across, upward, _ = project(camera, point)
    return round((across + 1) * size / 2), round(size - 1 - (upward + 1) * size / 2)


def _dark(camera: Camera, parts: object, poses: object, lamp: shadows.Lamp, light: Array) -> Array:
    """Return how dark the ground z = 0 is in each of 400 x 400 pixels."""
    size = (400, 400)
    with TinyRenderer(parts, 0.1) as renderer:  # type: ignore[arg-type]
        renderer.place(poses)  # type: ignore[arg-type]
        seen = renderer.render(lamp.camera, (shadows.MAP, shadows.MAP), light)
    away = -camera.eye[2] / camera.rays(size)[2]
    found = shadows.Shadows(camera, size, light).dark(np.arange(160_000), away, lamp, seen)
    return found.reshape(400, 400)
