"""The camera: axes, framing by closed form, and rays that lead back to what was seen."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from somo_cli.picture.camera import HALF_ANGLE, MARGIN, VIEWS, View, framing, radius_of
from tests.builders.projection import project

SIZES = [(960, 720), (300, 300), (200, 500)]


def cloud(seed: int, reach: float = 1.0) -> np.ndarray:
    return reach * np.random.default_rng(seed).normal(size=(60, 3)) * (1, 2, 0.5) + (3, -1, 2)


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
def test_axes_are_a_rotation(view: View) -> None:
    assert view.axes @ view.axes.T == pytest.approx(np.eye(3))
    assert np.linalg.det(view.axes) == pytest.approx(-1)  # right, up, forward


@pytest.mark.parametrize(
    ("name", "right", "forward"),
    [
        ("front", (1, 0, 0), (0, 1, 0)),
        ("side", (0, 1, 0), (-1, 0, 0)),
        ("top", (1, 0, 0), (0, 0, -1)),
    ],
)
def test_what_the_views_are_called(
    name: str, right: tuple[int, int, int], forward: tuple[int, int, int]
) -> None:
    axes = VIEWS[name].axes
    assert axes[0] == pytest.approx(right)
    assert axes[2] == pytest.approx(forward)


def test_the_oblique_view_is_from_above_with_the_vertical_upright() -> None:
    right, up, forward = VIEWS["oblique"].axes
    assert right[2] == 0
    assert up[2] > 0 > forward[2]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS)
@pytest.mark.parametrize("size", SIZES)
def test_everything_is_in_the_picture_and_the_picture_is_full(
    view: View, size: tuple[int, int], seed: int
) -> None:
    points = cloud(seed, 10.0 ** (seed - 2))
    seen = project(framing(points, view, size), points)
    across = np.abs(seen[:, :2]).max(axis=0)
    assert across.max() == pytest.approx(1 / MARGIN)
    # and in the middle of the direction that decides: two points are at opposite edges
    side = int(across.argmax())
    assert seen[:, side].max() == pytest.approx(-seen[:, side].min())
    assert seen[:, 2].min() > 0


def test_near_and_far_have_everything_between_them() -> None:
    points = cloud(0)
    camera = framing(points, VIEWS["oblique"], (960, 720))
    depths = project(camera, points)[:, 2]
    assert 0 < camera.near < depths.min() < depths.max() < camera.far


def test_a_target_is_in_the_middle_and_all_is_in_sight() -> None:
    points, target = cloud(1), (2.0, 0.0, 2.5)
    camera = framing(points, dataclasses.replace(VIEWS["oblique"], target=target), (960, 720))
    assert project(camera, np.array(target))[:2] == pytest.approx(0, abs=1e-12)
    assert np.abs(project(camera, points)[:, :2]).max() == pytest.approx(1 / MARGIN)


def test_a_distance_is_that_to_the_target() -> None:
    view = View(0.3, 0.4, distance=7.0, target=(1.0, 2.0, 3.0))
    assert project(framing(cloud(2), view, (960, 720)), np.array(view.target))[2] == pytest.approx(
        7
    )


def test_a_distance_without_a_target_is_that_to_the_middle() -> None:
    points = cloud(3)
    depths = project(framing(points, View(0.3, 0.4, distance=50.0), (960, 720)), points)[:, 2]
    assert (depths.min() + depths.max()) / 2 == pytest.approx(50)


@pytest.mark.parametrize("size", SIZES)
def test_the_shorter_side_has_the_angle(size: tuple[int, int]) -> None:
    tangents = framing(cloud(4), VIEWS["front"], size).tangents
    assert min(tangents) == pytest.approx(math.tan(HALF_ANGLE))
    assert tangents[0] / tangents[1] == pytest.approx(size[0] / size[1])


def test_rays_lead_to_what_is_seen_in_their_pixels() -> None:
    size = (40, 30)
    camera = framing(cloud(5), VIEWS["oblique"], size)
    rays = camera.rays(size).reshape(3, 30, 40)
    seen = project(camera, camera.eye + 2.5 * rays[:, 7, 11])
    assert seen == pytest.approx((2 * 11 / 40 - 1, 2 * (29 - 7) / 30 - 1, 2.5), abs=1e-5)


def test_rays_in_other_axes_are_the_same_rays() -> None:
    camera = framing(cloud(6), VIEWS["oblique"], (8, 6))
    axes = VIEWS["top"].axes
    assert camera.rays((8, 6), axes) == pytest.approx(axes @ camera.rays((8, 6)), abs=1e-6)


def test_radius_is_half_the_diagonal_of_the_box() -> None:
    assert radius_of(np.array([[0, 0, 0], [2, 3, 6.0]])) == pytest.approx(3.5)
