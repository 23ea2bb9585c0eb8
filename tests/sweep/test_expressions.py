"""Expressions of a study: arithmetic alone, with the place of what is wrong."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from somo_cli.sweep.expressions import ExpressionError, parse_expression
from somo_cli.sweep.reductions import Series

RAMP = Series(np.array([0.0, 1.0, 2.0]), np.array([1.0, 3.0, 2.0]))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * a", 7.0),
        ("-a ** 2", -9.0),
        ("a % 2 == 1 and not b", True),
        ("1 < a < 4", True),
        ("a if b else 5", 5.0),
        ("max(a, 7) - min(2, a) + abs(-1)", 6.0),
        ("sin(pi / 2) + hypot(3, 4)", 6.0),
        ("max(ramp) + last(ramp) - range(ramp)", 3.0),
        ("true and a > 2 or b", True),
    ],
)
def test_values(text: str, value: float | bool) -> None:
    expression = parse_expression(text)
    known = {"a": 3.0, "b": False, "ramp": RAMP}
    assert expression.names <= known.keys()
    found = pickle.loads(pickle.dumps(expression)).value(known)
    assert found == pytest.approx(value)
    assert isinstance(found, bool) is isinstance(value, bool)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 +", "this is not an expression"),
        ("a.b", "only numbers"),
        ("(lambda: 1)()", "only numbers"),
        ("[1 for x in a]", "only numbers"),
        ("'a' * 9", "only numbers"),
        ("__import__(1)", "there is no function '__import__'"),
        ("max(a, key=1)", "takes values alone"),
        ("max(*a)", "takes values alone"),
        ("sqrt()", "needs a value"),
        ("a // 2", "only + - * /"),
        ("a is b", "only + - * /"),
        ("(" * 400 + "1" + ")" * 400, "not an expression"),
        ("1" * 2000, "longer than"),
    ],
)
def test_what_is_no_arithmetic(text: str, message: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse_expression(text)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 / (a - 3)", "divides by zero"),
        ("9 ** 9 ** 9 ** 9", "too large"),
        ("sqrt(-a)", "not defined"),
        ("(-a) ** 0.5", "not a real number"),
        ("ramp", "is a column"),
        ("ramp and a", "neither true nor false"),
        ("median(a)", "needs a column"),
        ("sin(ramp)", "of a column"),
        ("sin(a, a)", "does not take these values"),
    ],
)
def test_what_has_no_value(text: str, message: str) -> None:
    with pytest.raises(ExpressionError, match=r".+") as caught:
        parse_expression(text).value({"a": 3.0, "ramp": RAMP})
    assert message in str(caught.value)


def test_a_name_that_is_a_constant_is_none_to_be_known() -> None:
    assert parse_expression("2 * pi").names == set()
    assert parse_expression("2 * pi").value({}) == 2 * math.pi
