"""Instants that runs with different steps share."""

from __future__ import annotations

from fractions import Fraction

import pytest

from somo_cli.analysis.common_instants import (
    NoCommonInstants,
    common_instants,
    exact_fraction,
    scaled_steps,
)


def test_a_ladder_is_written_in_decimals() -> None:
    rungs = [Fraction(4), Fraction(1), Fraction(1, 4)]
    assert scaled_steps(1e-3, rungs) == (4e-3, 1e-3, 2.5e-4)
    assert scaled_steps(3e-3, [Fraction(1, 3)]) == (1e-3,)


@pytest.mark.parametrize(
    ("steps", "duration", "interval", "count"),
    [
        ((1e-3,), 1.0, "0.02", 50),
        ((4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4), 1.0, "0.02", 50),
        ((3e-3, 2e-3), 1.0, "0.018", 55),  # meet every 6 ms
        ((1 / 240, 1 / 480), 1.0, None, None),  # no decimals, but a half is exactly one
        ((2e-2,), 0.5, "0.02", 25),
        ((3e-3,), 0.1, "0.003", 33),  # 0.099 s
    ],
)
def test_the_instants_are_steps_of_every_run(
    steps: tuple[float, ...], duration: float, interval: str | None, count: int | None
) -> None:
    found = common_instants(steps, duration)
    if interval is not None:
        assert (found.interval, found.count) == (Fraction(interval), count)
    assert duration - float(found.interval) < found.duration <= duration
    for step in steps:
        assert found.steps_between(step) * exact_fraction(step) == found.interval
        # the reference divides the smallest further
        assert found.steps_between(step / 8) == 8 * found.steps_between(step)


@pytest.mark.parametrize(
    ("steps", "duration"), [((1e-3, 1.1e-3, 1.3e-3, 1.7e-3), 1.0), ((0.2,), 1.0)]
)
def test_steps_that_hardly_meet_are_refused(steps: tuple[float, ...], duration: float) -> None:
    with pytest.raises(NoCommonInstants, match="meet only every"):
        common_instants(steps, duration)
