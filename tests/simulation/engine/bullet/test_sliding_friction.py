"""What friction lacks to point against the sliding, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.engine.bullet.sliding_friction import (
    NEGLIGIBLE,
    LinkMotion,
    Point,
    SlidingLink,
    missing_friction,
)

HELD = SlidingLink(LinkMotion((0, 0, 0), (0, 0, 0), (0, 0, 0)), 0.0, 0.0)
TANGENTS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
UP = (0.0, 0.0, 1.0)
STEP = 1e-3


def slider(*velocity: float, spin: tuple[float, float, float] = (0, 0, 0)) -> SlidingLink:
    return SlidingLink(LinkMotion((0, 0, 0.1), velocity, spin), 1 / 0.5, 0.0)


def point(x: float, y: float, *frictions: float) -> Point:
    first, second = frictions
    return Point((x, y, 0.0), UP, TANGENTS, (first, second))


def test_the_whole_friction_points_against_the_slip_and_keeps_its_size() -> None:
    found = missing_friction(slider(3, 4, 7), HELD, [point(0, 0, -1.0, 0.0)], STEP)
    assert found is not None
    assert np.add(found.force, (-1, 0, 0)) == pytest.approx((-0.6, -0.8, 0))
    assert found.share == 1
    assert not found.is_negligible


def test_nothing_is_missing_of_a_friction_that_is_right() -> None:
    found = missing_friction(slider(3, 4, 0), HELD, [point(0, 0, -0.6, -0.8)], STEP)
    assert found is not None
    assert found.is_negligible
    assert found.force == pytest.approx((0, 0, 0), abs=1e-15)


def test_a_point_that_sticks_has_no_direction() -> None:
    assert missing_friction(slider(0, 0, 1), HELD, [point(0, 0, -1, 0)], STEP) is None


def test_points_that_turn_about_their_middle_lack_a_torque() -> None:
    """Two points 0.1 m from the axis of a spin go along -y and y; their friction was along x."""
    spun = slider(0, 0, 0, spin=(0, 0, 5))
    found = missing_friction(spun, HELD, [point(-0.1, 0, 1, 0), point(0.1, 0, -1, 0)], STEP)
    assert found is not None
    assert found.point == pytest.approx((0, 0, 0))
    assert found.force == pytest.approx((0, 0, 0), abs=1e-15)
    assert found.torque == pytest.approx((0, 0, -0.2))


def test_against_what_moves_along_nothing_slides() -> None:
    belt = SlidingLink(LinkMotion((0, 0, 0), (3, 4, 0), (0, 0, 0)), 0.0, 0.0)
    assert missing_friction(slider(3, 4, 0), belt, [point(0, 0, -1, 0)], STEP) is None


def test_what_slides_slowly_takes_it_up_in_shares_that_add_up_to_all() -> None:
    """1 N on 0.5 kg changes the speed by 2 mm/s in a step; half of 1 mm/s is a quarter of that."""
    found = missing_friction(slider(6e-4, 8e-4, 0), HELD, [point(0, 0, -1, 0)], STEP)
    assert found is not None
    assert found.share == pytest.approx(0.25)
    applied = None
    for _ in range(60):
        applied = found.after(applied)
    assert applied is not None
    assert applied.force == pytest.approx((0.4, -0.8, 0), rel=1e-6)
    assert found.after(None).force == pytest.approx((0.1, -0.2, 0))


def test_little_is_a_share_of_the_friction() -> None:
    angle = 0.9 * NEGLIGIBLE
    found = missing_friction(
        slider(1, 0, 0), HELD, [point(0, 0, -np.cos(angle), -np.sin(angle))], STEP
    )
    assert found is not None
    assert found.is_negligible
