"""Decimals of many numbers at once, character by character those of `repr`."""

from __future__ import annotations

import functools
import math
import sys

import numpy as np
import pytest

from somo_cli.simulation.recording import shortest_float

COUNT = 100_000


def assert_as_repr(values: np.ndarray) -> None:
    table = np.asarray(values, dtype=np.float64).reshape(-1, 5)
    expected = [",".join(map(repr, row)) for row in table.tolist()]
    assert shortest_float.lines(table).decode().splitlines() == expected


def test_what_is_special() -> None:
    positive = [
        0.0, 1.0, 2.0, 9.5, 10.0, 11.25, 1e16, 1e22, 123456.0, 0.5, 0.1, 0.05, 0.3, 1e-4, 1e-5,
        2e-5, 1.5e-5, 9.999999999999998, 0.30000000000000004, 1.0000000000000002, 1e-200, 1e-201,
        5e-324, 2.2250738585072014e-308, sys.float_info.max, 5e-7, 4.35, 0.018, 9007199254740993.0,
        2.0**-44, 9.5367431640625e-07, math.inf, math.nan, 0.000123, 1e-10,
    ]  # fmt: skip
    assert_as_repr(np.array([*positive, *(-one for one in positive)]))


@functools.cache
def sets_of_numbers() -> dict[str, np.ndarray]:
    random = np.random.default_rng(11)
    size = random.uniform(-1, 1, COUNT)
    places = random.integers(-200, 4, COUNT)
    powers = 10.0 ** random.integers(-200, 2, COUNT)
    return {
        "of order one": size,
        "of any order": size * 10 ** random.uniform(-210, 20, COUNT),
        "of few digits": np.round(size * 10, 3),
        "of one digit": random.integers(-9, 10, COUNT) * powers,
        "of sixteen digits": np.round(size, 16),
        "beside powers of ten": powers * (1 + random.integers(-6, 7, COUNT) * 2.0**-53),
        "powers of two": np.ldexp(1.0, places),
        "beside powers of two": np.nextafter(np.ldexp(1.0, places), random.choice([-9, 9], COUNT)),
        "any bits": random.integers(0, 2**64, COUNT, dtype=np.uint64).view(np.float64),
        "halves in the last digit": random.integers(10**16, 10**17, COUNT) / 2.0**56,
    }


@pytest.mark.moderate
@pytest.mark.parametrize("name", sets_of_numbers())
def test_any_numbers(name: str) -> None:
    assert_as_repr(sets_of_numbers()[name])


def test_most_numbers_need_no_repr(monkeypatch: pytest.MonkeyPatch) -> None:
    reported: list[float] = []
    monkeypatch.setattr(
        shortest_float, "repr", lambda value: reported.append(value) or repr(value), raising=False
    )
    assert_as_repr(sets_of_numbers()["of order one"])
    assert len(reported) < 1e-4 * COUNT


@pytest.mark.parametrize("shape", [(0, 3), (2, 0)])
def test_an_empty_table(shape: tuple[int, int]) -> None:
    assert shortest_float.lines(np.zeros(shape)) == b"\n" * shape[0]
