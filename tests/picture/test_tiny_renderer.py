"""The renderer against closed forms: where a solid appears, how far away, and which one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import AnySolid, Box, Sphere
from somo_cli.picture.camera import Camera, View
from somo_cli.picture.drawn_parts import Part
from somo_cli.picture.facets import facets
from somo_cli.picture.tiny_renderer import AMBIENT, TinyRenderer

pytest.importorskip("pybullet")

SIZE = (200, 150)
TANGENT = 0.2


def part(solid: AnySolid, colour: tuple[float, float, float] = (1, 1, 1)) -> Part:
    return Part(0, 0, facets(solid), Pose(), colour, is_framed=True)


def camera(distance: float) -> Camera:
    """Return a camera that looks along +y at the origin, from a distance."""
    axes = View(0.0, 0.0).axes
    tangents = (TANGENT * 4 / 3, TANGENT)
    return Camera(np.array([0, -distance, 0.0]), axes, tangents, distance / 2, 3 * distance)


@pytest.mark.parametrize("unit", [1e-4, 1.0, 500.0])
def test_a_box_appears_where_and_as_large_as_it_is(unit: float) -> None:
    box = Box((0.4 * unit, 0.2 * unit, 0.6 * unit))
    with TinyRenderer([part(box)], unit) as renderer:
        renderer.place([Pose((0.1 * unit, 0, 0))])
        raster = renderer.render(camera(4 * unit), SIZE, np.array([0, -1.0, 0]))
    rows, columns = np.nonzero(raster.parts == 0)
    scale = SIZE[1] / 2 / TANGENT / 3.9  # pixels for a length of one unit, at its front
    assert columns.min() == pytest.approx(SIZE[0] / 2 - 0.1 * scale, abs=1)
    assert columns.max() == pytest.approx(SIZE[0] / 2 + 0.3 * scale, abs=1)
    assert np.ptp(rows) == pytest.approx(0.6 * scale - 1, abs=1)
    assert raster.distances[raster.parts == 0] == pytest.approx(3.9 * unit, rel=1e-4)
    assert np.isinf(raster.distances[raster.parts < 0]).all()


def test_a_ball_is_as_far_away_as_its_surface() -> None:
    with TinyRenderer([part(Sphere(0.3))], 1.0) as renderer:
        renderer.place([Pose()])
        eye = camera(4)
        raster = renderer.render(eye, SIZE, np.array([0, -1.0, 0]))
    rays = eye.rays(SIZE).reshape(3, *SIZE[::-1]).transpose(1, 2, 0)
    points = eye.eye + rays * np.where(raster.parts == 0, raster.distances, 0)[..., None]
    radii = np.linalg.norm(points[raster.parts == 0], axis=1)
    assert radii == pytest.approx(0.3, rel=0.01)


def test_parts_are_identified_by_number_and_the_nearer_one_is_seen() -> None:
    parts = [part(Box((1, 0.1, 1))), part(Box((0.5, 0.1, 0.5))), part(Box((0.1, 0.1, 0.1)))]
    with TinyRenderer(parts, 1.0) as renderer:
        renderer.place([Pose(), Pose((0, -0.5, 0)), Pose((0, 0.5, 0))])
        raster = renderer.render(camera(4), SIZE, np.array([0, -1.0, 0]))
    assert raster.parts[75, 100] == 1
    assert set(np.unique(raster.parts)) == {-1, 0, 1}  # the third is hidden


def test_the_colour_in_the_shadow_is_its_ambient_part() -> None:
    colour = (0.2, 0.6, 1.0)
    with TinyRenderer([part(Box((1, 1, 1)), colour)], 1.0) as renderer:
        renderer.place([Pose()])
        away = renderer.render(camera(4), SIZE, np.array([0, 1.0, 0])).colours[75, 100]
        slant = np.array([math.sin(1.2), -math.cos(1.2), 0])
        lit = renderer.render(camera(4), SIZE, slant).colours[75, 100]
    assert away == pytest.approx(255 * AMBIENT * np.array(colour), abs=1.5)
    assert (lit > away).all()


def test_it_prints_nothing_and_leaves_no_client_behind(capfd: pytest.CaptureFixture[str]) -> None:
    renderer = TinyRenderer([part(Box((1, 1, 1)))], 1.0)
    with renderer:
        renderer.render(camera(4), SIZE, np.array([0, -1.0, 0]))
    renderer.close()
    assert capfd.readouterr() == ("", "")
