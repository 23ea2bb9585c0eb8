"""Motion between rows, and the columns that rows must have."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.picture.drawn_parts import Configuration, parts_of, poses_at, start_configuration
from somo_cli.picture.recorded_motion import RecordedMotion, scene_to_draw
from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file

POSE = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")


def of_cube(*turns: float, sign: float = 1.0) -> RecordedMotion:
    """Return rows a second apart, in which the cube of a scene goes on by 1 m and turns about z."""
    scene = scene_from_file("push_scene.yaml")
    times = tuple(map(float, range(len(turns))))
    table: dict[str, tuple[float, ...]] = {"time_s": times}
    for joint in scene.manipulators[0].compiled.chain.joints:
        table[f"finger.{joint.name}.angle_rad"] = tuple(0.1 * time for time in times)
    rows = [
        (time, 2.0, 3.0, 0.0, 0.0, sign**time * math.sin(turn / 2), sign**time * math.cos(turn / 2))
        for time, turn in zip(times, turns, strict=True)
    ]
    for name, values in zip(POSE, zip(*rows, strict=True), strict=True):
        table[f"cube.pose.{name}"] = values
    return RecordedMotion(scene, table)


def turn_of(configuration: Configuration) -> float:
    (pose,) = configuration.objects
    return math.atan2(pose.rotation[1][0], pose.rotation[0][0])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("time", [0.0, 0.25, 0.5, 1.0, 1.75, 2.0])
def test_between_rows_everything_moves_at_constant_rates(time: float, sign: float) -> None:
    configuration = of_cube(0.0, 1.0, 2.0, sign=sign).at(time)
    assert turn_of(configuration) == pytest.approx(time)
    assert configuration.objects[0].position == pytest.approx((time, 2, 3))
    assert configuration.angles[0] == pytest.approx([0.1 * time] * 10)


def test_a_body_turns_the_shorter_way() -> None:
    assert turn_of(of_cube(0.0, 2 * math.pi - 0.2).at(0.5)) == pytest.approx(-0.1)


def test_a_row_is_shown_as_it_is() -> None:
    recording = of_cube(0.3, 1.7)
    assert recording.at(1.0).angles == ([0.1] * 10,)
    quaternion = tuple(recording.columns[f"cube.pose.{name}"][1] for name in POSE[3:])
    x, y, z, w = quaternion
    rotation = geometry.rotation_from_quaternion((x, y, z, w))
    assert np.array(recording.at(1.0).objects[0].rotation) == pytest.approx(np.array(rotation))


def test_one_row_is_a_recording() -> None:
    assert turn_of(of_cube(0.4).at(0.0)) == pytest.approx(0.4)


def test_what_a_picture_needs_is_what_the_scene_for_it_records() -> None:
    for name in ("push_scene.yaml", "lift_scene.yaml", "snake_scene.yaml", "hand_scene.yaml"):
        scene = scene_from_file(name)
        names = columns.header(make_plan(scene_to_draw(scene)).recorded)
        wanted = RecordedMotion(scene, {}).required_columns()
        assert set(wanted) <= set(names)
        # base_pose of what does not move, and of what is moved, is recorded and not needed
        assert all(".base_pose." in name for name in set(names[1:]) - set(wanted))


def test_a_base_and_an_object_with_prescribed_motion_need_no_columns() -> None:
    scene = scene_from_file("lift_scene.yaml")
    angles = tuple(
        f"{one.name}.{joint.name}.angle_rad"
        for one in scene.manipulators
        for joint in one.compiled.chain.joints
    )
    cube = tuple(f"cube.pose.{name}" for name in POSE)
    assert RecordedMotion(scene, {}).required_columns() == angles + cube
    fixed = dataclasses.replace(
        scene, objects=tuple(dataclasses.replace(one, is_fixed=True) for one in scene.objects)
    )
    assert RecordedMotion(fixed, {}).required_columns() == angles
    table = {"time_s": (0.0, 2.0), **dict.fromkeys(angles, (0.0, 0.0))}
    configuration = RecordedMotion(fixed, table).at(2.0)
    start = start_configuration(fixed)
    assert configuration.objects == start.objects
    for base, first in zip(configuration.bases, start.bases, strict=True):
        assert base.position == pytest.approx(np.add(first.position, (0, 0, 0.05)))


@pytest.mark.slow
def test_a_simulated_motion_is_interpolated_to_second_order() -> None:
    pytest.importorskip("pybullet")
    scene = dataclasses.replace(scene_to_draw(scene_from_file("snake_scene.yaml")), every=1)
    names = columns.header(make_plan(scene).recorded)
    rows = rows_of(scene, 480)
    whole = RecordedMotion(scene, dict(zip(names, zip(*rows, strict=True), strict=True)))
    parts = parts_of(scene)

    def position_error(stride: int) -> float:
        """Return the largest error of any coordinate [m] with every `stride`-th row."""
        kept = dict(zip(names, zip(*rows[::stride], strict=True), strict=True))
        motion = RecordedMotion(scene, kept)
        return max(
            float(np.abs(np.subtract(one.position, other.position)).max())
            for time in (0.1201, 0.2005, 0.29, 0.3711)
            for one, other in zip(
                poses_at(scene, parts, motion.at(time)),
                poses_at(scene, parts, whole.at(time)),
                strict=True,
            )
        )

    assert position_error(80) < 2e-2
    assert position_error(20) < position_error(80) / 8  # towards a sixteenth
