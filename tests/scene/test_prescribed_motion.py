"""Where a path leads: turned about a point, then displaced, at every time."""

from __future__ import annotations

import math
from typing import Any

import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.prescribed_motion import PosePath, read_motion

START = Pose.of((1.0, 0.0, 0.5), (0.2, -0.3, 0.4))


def path(start: Pose = START, **data: Any) -> PosePath:
    return read_motion(data).path_from(start)


def turned(pose: Pose, start: Pose = START) -> tuple[float, ...]:
    """Return the rotation vector, in the world, that leads from the start to a pose."""
    return geometry.rotation_vector(
        geometry.multiply(pose.rotation, geometry.transposed(start.rotation))
    )


def test_at_the_start_it_is_where_it_starts() -> None:
    one = path(translation=[[0, 0, 0, 0], [1, 1, 2, 3]], rotation=[[0, 0, 0, 0], [1, 1, 2, 3]])
    assert one.at(0.0) == START
    assert one.at(-1.0) == START


def test_a_displacement_is_in_the_axes_of_the_world() -> None:
    one = path(translation=[[0, 0, 0, 0], [2, 0.1, 0.2, 0.3]], interpolation="linear")
    assert one.at(1.0).position == pytest.approx((1.05, 0.1, 0.65))
    assert one.at(5.0).position == pytest.approx((1.1, 0.2, 0.8))
    assert one.at(1.0).rotation == START.rotation


def test_it_turns_about_its_own_origin_or_a_point() -> None:
    quarter = [[0, 0, 0, 0], [1, 0, 0, math.pi / 2]]
    own = path(rotation=quarter).at(1.0)
    assert own.position == pytest.approx(START.position)
    assert turned(own) == pytest.approx((0, 0, math.pi / 2))
    about = path(rotation=quarter, about=[0, 0, 9]).at(1.0)
    assert about.position == pytest.approx((0, 1, 0.5))
    assert about.rotation == own.rotation


def test_the_displacement_carries_the_point_along() -> None:
    both = path(
        rotation=[[0, 0, 0, 0], [1, 0, 0, math.pi / 2]],
        translation=[[0, 0, 0, 0], [1, 0, 0, 2]],
        about=[0, 0, 0],
    )
    assert both.at(1.0).position == pytest.approx((0, 1, 2.5))


def test_angles_beyond_half_a_turn_are_turned_in_full() -> None:
    one = path(rotation=[[0, 0, 0, 0], [1, 0, 0, 3 * math.pi]], interpolation="linear")
    assert turned(one.at(1 / 6)) == pytest.approx((0, 0, math.pi / 2))
    assert turned(one.at(0.5)) == pytest.approx((0, 0, -math.pi / 2))
    assert abs(turned(one.at(1.0))[2]) == pytest.approx(math.pi)


def test_a_cubic_is_at_rest_at_both_ends_and_smooth_between() -> None:
    one = path(translation=[[0, 0, 0, 0], [1, 1, 0, 0], [2, 0, 0, 0]])
    x = [one.at(time).position[0] - 1 for time in (1e-4, 1 - 1e-4, 1.0, 1 + 1e-4, 2 - 1e-4)]
    assert x == pytest.approx([0, 1, 1, 1, 0], abs=1e-6)


def test_it_repeats() -> None:
    one = path(translation=[[0, 0, 0, 0], [0.5, 1, 0, 0], [1, 0, 0, 0]], repeat=True)
    assert one.at(7.25).position == pytest.approx(one.at(0.25).position)
    assert one.stationary_until(7.25, 0.1) == 7.25


@pytest.mark.parametrize(
    ("interpolation", "expected"), [("linear", (1 - 0.01, 0.0, 0.5)), ("cubic", None)]
)
def test_before_the_start_it_moved_as_it_does_then(interpolation: str, expected: Any) -> None:
    one = path(translation=[[0, 0, 0, 0], [1, 1, 0, 0]], interpolation=interpolation)
    before = one.pose_before_start(0.01).position
    # the cubic 3 s² - 2 s³ on the other side of zero
    assert before == pytest.approx(expected or (1 + 3e-4 + 2e-6, 0, 0.5))
    late = path(translation=[[0.5, 0, 0, 0], [1, 1, 0, 0]], interpolation=interpolation)
    assert late.pose_before_start(0.01) == START


def test_it_is_held_while_the_next_pose_is_the_same() -> None:
    one = path(translation=[[1, 0, 0, 0], [2, 1, 0, 0]], interpolation="linear")
    assert one.stationary_until(0.0, 0.1) == pytest.approx(0.9)
    assert one.stationary_until(0.95, 0.1) == 0.95
    assert one.stationary_until(1.5, 0.1) == 1.5
    assert one.stationary_until(2.0, 0.1) == math.inf


def test_lengths_are_scaled_and_angles_are_not() -> None:
    data = {"translation": [[2, 1, 0, 0]], "rotation": [[2, 1, 0, 0]], "about": [0, 0, 1]}
    found = scaled(read_motion(data), Scale(20, 3))
    assert found.translation == ((2, 20, 0, 0),)
    assert found.rotation == ((2, 1, 0, 0),)
    assert found.about == (0, 0, 20)
    assert scaled(read_motion({}), Scale(20)) == read_motion({})


@pytest.mark.parametrize("vector", [(0.0, 0.0, 0.0), (1e-9, 0, 0), (0.3, -2, 1), (0, 3.14, 0)])
def test_a_rotation_vector_is_axis_times_angle(vector: geometry.Vector) -> None:
    angle = geometry.norm(vector)
    axis = geometry.unit(vector) if angle else (1.0, 0.0, 0.0)
    found = geometry.rotation_vector(geometry.rotation_about(axis, angle))
    assert found == pytest.approx(vector, abs=1e-12)
