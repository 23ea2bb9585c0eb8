"""The ground's squares, and pixels that are made of several."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.picture.shading import smoothed, tile_edge


@pytest.mark.parametrize(
    ("radius", "square"),
    [(0.19, 0.05), (0.2, 0.1), (1.0, 0.5), (0.039, 0.01), (0.04, 0.02), (3e-4, 1e-4), (7.0, 2.0)],
)
def test_squares_are_one_two_or_five_times_a_power_of_ten(radius: float, square: float) -> None:
    assert tile_edge(radius) == pytest.approx(square)


def test_a_pixel_is_the_mean_of_those_it_stands_for() -> None:
    picture = np.zeros((4, 6, 3), np.float32)
    picture[0, 0] = (255, 0, 100)
    picture[:2, 2:4] = 200
    picture[3, 5] = 9999  # brighter than white
    small = smoothed(picture, 2)
    assert small.shape == (2, 3, 3)
    assert small.dtype == np.uint8
    assert small[0, 0].tolist() == [64, 0, 25]
    assert small[0, 1].tolist() == [200] * 3
    assert small[1, 2].tolist() == [255] * 3
