"""Where round bodies stand, and which bodies are round."""

from __future__ import annotations

import math

import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Link, Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.round_solids import Capsule
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Inertial, Sphere
from somo_cli.scene.round_body import RoundBody, round_body_of

PAINT = Material("paint", (1.0, 1.0, 1.0, 1.0))
UP = (0.0, 0.0, 1.0)
LYING = RoundBody((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.02)


def link(*solids: tuple[AnySolid, float]) -> Link:
    shapes = tuple(Shape(solid, (0.0, 0.0, z), geometry.ZERO, PAINT, 1.0) for solid, z in solids)
    return Link("link", Inertial(1.0, geometry.ZERO, (1, 0, 0, 1, 0, 1)), shapes)


def test_an_old_point_moves_back_below_the_axis_at_its_position_along_it() -> None:
    old = (0.013, 0.02 * math.sin(0.2), -0.02 * math.cos(0.2))
    assert geometry.add(old, LYING.offset_to_line(old, UP)) == pytest.approx((0.013, 0, -0.02))


def test_a_ball_stands_right_below_its_centre() -> None:
    ball = RoundBody((0.0, 0.0, 0.3), None, 0.1)
    assert geometry.add((0.05, 0, 0.22), ball.offset_to_line((0.05, 0, 0.22), UP)) == pytest.approx(
        (0, 0, 0.2)
    )


def test_a_cylinder_on_its_face_stands_where_it_touches() -> None:
    standing = RoundBody(geometry.ZERO, UP, 0.02)
    assert standing.offset_to_line((0.013, 0.004, -0.03), UP) == geometry.ZERO


def test_the_same_in_another_frame() -> None:
    axes = geometry.rotation_from_rpy((0.3, -0.4, 1.1))
    origin = (0.1, -0.2, 0.05)
    old = (0.013, 0.004, -0.0195)
    back = geometry.transposed(axes)
    seen = geometry.rotate(back, geometry.subtract(old, origin))
    offset = LYING.seen_from(origin, axes).offset_to_line(seen, geometry.rotate(back, UP))
    assert geometry.rotate(axes, offset) == pytest.approx(LYING.offset_to_line(old, UP))


def test_a_force_that_is_moved_ahead_turns_the_body_back() -> None:
    """What rolls along y turns about -x; a force up that is moved to +y turns it about +x."""
    assert geometry.cross((0, 0.001, 0), (0, 0, 3)) == pytest.approx((0.003, 0, 0))


@pytest.mark.parametrize(
    ("body", "is_round"),
    [
        (link((Capsule(0.1, 0.02), 0.0)), True),
        (link((Sphere(0.02), 0.3)), True),
        (link((Cylinder(0.1, 0.02), 0.05), (Sphere(0.02), 0.1)), True),
        (link((Cylinder(0.1, 0.02), 0.05), (Sphere(0.03), 0.1)), False),
        (link((Sphere(0.02), 0.0), (Sphere(0.02), 0.1)), False),
        (link((Box((0.1, 0.1, 0.1)), 0.0)), False),
        (link((Cylinder(0.1, 0.02), 0.0), (Box((0.1, 0.1, 0.1)), 0.0)), False),
        (link(), False),
    ],
)
def test_what_is_round(body: Link, is_round: bool) -> None:
    assert (round_body_of(body) is not None) == is_round
