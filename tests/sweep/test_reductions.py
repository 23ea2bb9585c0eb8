"""What a label takes of a column, against columns for which it is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.sweep.reductions import NEEDS, REDUCTIONS, Options, Series, reduced

TIME = np.array([0.0, 0.5, 1.0, 2.0])
ZIGZAG = Series(TIME, np.array([0.0, 1.0, -1.0, 3.0]))
"""Straight lines from 0 to 1 to -1 to 3."""


CASES = [
    ("first", {}, 0.0),
    ("last", {}, 3.0),
    ("min", {}, -1.0),
    ("max", {}, 3.0),
    ("range", {}, 4.0),
    ("median", {}, 0.5),
    ("std", {}, np.std([0, 1, -1, 3])),
    ("integral", {}, 0.25 + 0.0 + 1.0),
    ("mean", {}, 1.25 / 2),
    ("at", {"at": 1.25}, 0.0),
    ("time_above", {"level": 0.0}, 0.5 + 0.25 + 0.75),
    ("time_below", {"level": 0.0}, 0.25 + 0.25),
    ("time_above", {"level": 2.0}, 0.25),
    ("first_above", {"level": 0.5}, 0.25),
    ("first_above", {"level": 5.0}, math.nan),
    ("first_above", {"level": -1.0}, 0.0),
    ("first_below", {"level": -0.5}, 0.875),
    ("crossings", {"level": 0.5}, 2.0),
    ("settle_time", {"within": 5.0}, 0.0),
    ("settle_time", {"within": 2.5}, 2.0),
    ("per_cycle", {"period": 1.0}, 1.5),
    ("per_cycle", {"period": 3.0}, math.nan),
]


@pytest.mark.parametrize(("take", "options", "value"), CASES)
def test_a_reduction_takes_the_known_number(
    take: str, options: dict[str, float], value: float
) -> None:
    assert reduced(ZIGZAG, take, Options(**options)) == pytest.approx(value, nan_ok=True)


def test_every_reduction_is_tested_above() -> None:
    tested = {take for take, _, _ in CASES}
    assert tested == REDUCTIONS.keys() >= NEEDS.keys()


def test_rows_between_two_times() -> None:
    assert reduced(ZIGZAG.between(0.5, 1.0), "max") == 1.0
    assert reduced(ZIGZAG.between(1.5, None), "mean") == 3.0  # one row
    assert math.isnan(reduced(ZIGZAG.between(5.0, None), "max"))


def test_a_constant_column_is_never_above_itself() -> None:
    flat = Series(TIME, np.full(4, 2.0))
    assert reduced(flat, "time_above", Options(level=2.0)) == 0.0
    assert reduced(flat, "time_above", Options(level=1.0)) == 2.0
