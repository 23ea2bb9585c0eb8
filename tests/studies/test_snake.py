"""The crawling snake: what its speed depends on, and what it does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.studies import snake
from tests.studies.planar_snake import GRAVITY, PlanarSnake
from tests.studies.snake import GAIT, Crawl

pytest.importorskip("pybullet")
pytestmark = pytest.mark.slow

COARSE = Crawl(step=2e-3, seconds=1.0)


def speeds_of(*crawls: Crawl) -> list[float]:
    """Return how far the snake gets in the last second [m]."""
    return snake.speeds(crawls, 1.0, processes=1)


def test_the_speed_is_that_of_the_planar_model() -> None:
    (speed,) = speeds_of(replace(COARSE, step=1e-3))
    assert speed == pytest.approx(snake.opinions([COARSE], 1.0)[0], rel=0.01)


def test_neither_the_world_scale_nor_the_stiffness_of_the_belly_matters() -> None:
    short = replace(COARSE, seconds=0.5)
    belly = ("contact_stiffness=6000", "contact_damping=20")
    found = speeds_of(
        short,
        replace(short, sets=("world_scale=10",)),
        replace(short, sets=("world_scale=40",)),
        replace(short, sets=tuple(f"manipulators[0].surface.{one}" for one in belly)),
    )
    assert found == pytest.approx([found[0]] * 4, rel=2e-3)


def test_it_goes_as_fast_base_ahead_as_tip_ahead() -> None:
    """In the second period; the first one depends on what the start cost (first order)."""
    found = speeds_of(*(replace(one, seconds=2.0) for one in (COARSE, snake.mirrored(COARSE))))
    assert found[1] == pytest.approx(found[0], rel=3e-3)


def test_with_equal_factors_it_does_not_get_away() -> None:
    found = speeds_of(replace(COARSE, seconds=2.0), replace(COARSE, seconds=2.0, sets=snake.EQUAL))
    assert found[1] < 0.1 * found[0]


def test_the_second_opinion_slides_as_the_law_of_friction_says() -> None:
    """Stiff and thrown along itself or across, it is a block."""
    model: PlanarSnake = snake.snake()
    still = replace(GAIT, amplitude=0.0)
    size = len(model.masses) + 2
    for direction, factor in ((0, 0.1), (1, 1.0)):
        state = np.zeros(2 * size)
        state[size + direction] = 0.5
        change = model.rates(still, 0.0, state)[size:]
        slowed = change[direction] + direction * model.shares @ change[2:]
        assert slowed == pytest.approx(-0.5 * factor * GRAVITY, rel=1e-5)
