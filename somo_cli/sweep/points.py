"""The parameter sets of a study: a grid, a zip, slices, random points, or the rows of a table."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from somo_cli.arrays import Array
from somo_cli.sweep.expressions import ExpressionError
from somo_cli.sweep.study import Combination, Parameter

MAX_POINTS = 1_000_000


def spaced(first: float, last: float, count: int, is_log: bool) -> tuple[float, ...]:
    """Return evenly spaced values, or those of which the logarithms are; both ends are exact.

    Evenly spaced ones are as near as a float is to the decimals that one would write: 0.042, and
    not 0.041999999999999996.
    """
    if count == 1:
        return (first,)
    if is_log:
        shares = [number / (count - 1) for number in range(1, count - 1)]
        return (first, *(first * (last / first) ** share for share in shares), last)
    start, end = (Fraction(repr(value)) for value in (first, last))
    return tuple(float(start + (end - start) * n / (count - 1)) for n in range(count))


def whole_as_integer(value: float) -> float:
    """Return a whole number as an integer, any other as it is."""
    return int(value) if value.is_integer() and abs(value) < 2**53 else value


def number_of_points(
    parameters: Sequence[Parameter], combination: Combination, count: int | None
) -> int:
    """Return how many sets there will be; `count` is that of random ones, or of rows."""
    lengths = [len(one.values) for one in parameters if one.values]
    match combination:
        case "grid":
            return math.prod(lengths)
        case "zip":
            return max(lengths, default=1)
        case "slices":
            return 1 + sum(length - 1 for length in lengths)
        case _:
            return count or 0


def combined(
    parameters: Sequence[Parameter],
    combination: Combination,
    count: int = 0,
    seed: int = 0,
    rows: Sequence[Sequence[Any]] = (),
) -> tuple[dict[str, Any], ...]:
    """Return the sets in their order; the last parameter of a grid varies fastest.

    `slices` go through the first value of every parameter. `rows` are those of a table. The values
    of expressions follow; raises ExpressionError if one has none.
    """
    varied = [one for one in parameters if one.expression is None]
    names = [one.name for one in varied]
    if combination == "grid":
        sets: Iterator[Sequence[Any]] = itertools.product(*(one.values for one in varied))
    elif combination == "zip":
        sets = zip(*(one.values for one in varied), strict=True)
    elif combination == "slices":
        sets = _slices([one.values for one in varied])
    elif combination == "table":
        sets = iter(rows)
    else:
        sets = iter(_sampled(varied, _shares(len(varied), count, seed, combination)))
    return tuple(
        _with_expressions(parameters, dict(zip(names, values, strict=True))) for values in sets
    )


def _slices(values: Sequence[Sequence[Any]]) -> Iterator[Sequence[Any]]:
    base = [one[0] for one in values]
    yield base
    for place, own in enumerate(values):
        for value in own[1:]:
            yield [*base[:place], value, *base[place + 1 :]]


def _shares(parameters: int, count: int, seed: int, combination: Combination) -> Array:
    """Return numbers from 0 to 1, (count, parameters).

    Of a Latin hypercube each of `count` equal parts has one of each parameter: McKay, Beckman,
    Conover, Technometrics 21 (1979) 239. Sobol points are scrambled: Owen, J. Complexity 14
    (1998) 466; their first powers of two are balanced.
    """
    if combination == "sobol":
        from scipy.stats import qmc  # slow to import

        exponent = max(0, math.ceil(math.log2(max(1, count))))
        points: Array = qmc.Sobol(parameters, seed=seed).random_base2(exponent)[:count]
        return points
    generator = np.random.default_rng(seed)
    columns = []
    for _ in range(parameters):
        shares = generator.random(count)
        if combination == "latin_hypercube":
            shares = (generator.permutation(count) + shares) / max(1, count)
        columns.append(shares)
    return np.array(columns).T


def _sampled(parameters: Sequence[Parameter], shares: Array) -> list[list[Any]]:
    """Return a set for each row of shares; a parameter with values takes any of them."""
    return [
        [_value(one, float(share)) for one, share in zip(parameters, row, strict=True)]
        for row in shares
    ]


def _value(parameter: Parameter, share: float) -> Any:
    if parameter.bounds is None:
        size = len(parameter.values)
        return parameter.values[min(size - 1, int(share * size))]
    return _between(parameter.bounds, share, parameter.is_log)


def _between(bounds: tuple[float, float], share: float, is_log: bool) -> float:
    first, last = bounds
    return float(first * (last / first) ** share if is_log else first + (last - first) * share)


def _with_expressions(parameters: Sequence[Parameter], point: dict[str, Any]) -> dict[str, Any]:
    """Return a set with the values of expressions, in the order of the parameters.

    Whole values are integers, as those of a table: a scene may ask for a number of segments.
    """
    waiting = {one.name: one.expression for one in parameters if one.expression is not None}
    while waiting:
        ready = next((name for name, one in waiting.items() if one.names <= point.keys()), None)
        if ready is None:
            raise ExpressionError(f"'{next(iter(waiting))}' depends on itself")
        expression = waiting.pop(ready)
        known = {name: point[name] for name in expression.names}
        if not all(isinstance(value, int | float) for value in known.values()):
            raise ExpressionError(f"'{expression.text}' needs numbers")
        value = expression.value(known)
        point[ready] = value if isinstance(value, bool) else whole_as_integer(value)
    return {one.name: point[one.name] for one in parameters}
