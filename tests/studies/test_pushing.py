"""The planar arm pushes a block to its goal, and with a flick beyond it."""

from __future__ import annotations

import pytest

from tests.studies import pushing
from tests.studies.pushing import FLICK, GRAVITY, SLOW
from tests.studies.running import recorded

pytest.importorskip("pybullet")
pytestmark = pytest.mark.slow


def push(friction: float, rise: float, time_step: float, *sets: str) -> pushing.Push:
    """Return what becomes of the block."""
    return pushing.pushed(recorded(pushing.setting(friction, rise, time_step, *sets)))


def test_the_block_gets_to_its_goal_whatever_the_step_and_the_scale() -> None:
    found = [
        push(1.0, SLOW, 2e-3),
        push(1.0, SLOW, 1e-3),
        push(1.0, SLOW, 2e-3, "world_scale=10"),
        push(1.0, SLOW, 2e-3, "world_scale=40"),
    ]
    for one in found:
        assert one.off_goal < 4e-3
        assert one.coasted < 1e-5  # it touches the arm to the end
        assert one.distance == pytest.approx(found[0].distance, rel=5e-3)


def test_pushed_slowly_it_goes_as_far_whatever_the_friction() -> None:
    assert push(0.25, SLOW, 2e-3).distance == pytest.approx(
        push(1.0, SLOW, 2e-3).distance, rel=0.02
    )


def test_flicked_it_slides_on_until_friction_has_taken_its_energy() -> None:
    """A little farther than without its spin, which takes a share of the friction."""
    one = push(0.25, FLICK, 2e-3)
    alone = one.speed**2 / (2 * 0.25 * GRAVITY)
    assert alone < one.coasted < 1.1 * alone
    assert one.distance > 1.5 * push(0.25, SLOW, 2e-3).distance
