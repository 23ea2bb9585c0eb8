"""When the pictures of a film are taken."""

from __future__ import annotations

from fractions import Fraction

import pytest

from somo_cli.picture.frame_times import rate_of, times_of


@pytest.mark.parametrize(
    ("first", "last", "every", "count"),
    [(0, 1, 0.1, 11), (0, 1, 0.3, 4), (0.5, 0.5, 0.1, 1), (0, 0.05, 0.1, 1), (0, 4.8, 0.04, 121)],
)
def test_times_go_up_to_the_last(first: float, last: float, every: float, count: int) -> None:
    times = times_of(first, last, every)
    assert len(times) == count
    assert times == pytest.approx([first + number * every for number in range(count)])
    assert times[-1] <= last < times[-1] + every * (1 + 1e-6)


def test_rounding_drops_no_picture() -> None:
    assert all(len(times_of(0, n * 0.1, 0.1)) == n + 1 for n in range(200))


@pytest.mark.parametrize(
    ("every", "speed", "rate"),
    [(0.04, 1, Fraction(25)), (1 / 30, 1, Fraction(30)), (0.01, 0.25, Fraction(25))],
)
def test_the_rate_is_a_plain_fraction(every: float, speed: float, rate: Fraction) -> None:
    assert rate_of(every, speed) == rate
