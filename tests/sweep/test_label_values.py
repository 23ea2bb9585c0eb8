"""The labels of a run, from its columns and its parameters."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.sweep.expressions import ExpressionError, parse_expression
from somo_cli.sweep.label_values import is_kept, label_values
from somo_cli.sweep.study import Label

NAMES = ("time_s", "ball.pose.z_m")
ROWS = np.array([[0.0, 0.1], [0.5, 0.3], [1.0, 0.2]])
RISE = Label("rise", "ball.pose.z_m", "last")
HEIGHT = Label("height", "ball.pose.z_m")
EARLY = Label("early", "ball.pose.z_m", "max", before=0.25)


def expressed(name: str, text: str) -> Label:
    return Label(name, expression=parse_expression(text))


def test_a_whole_column_is_for_expressions_alone() -> None:
    labels = (
        expressed("good", "over and rise > size"),
        expressed("over", "max(height) > 0.25"),
        *(RISE, HEIGHT, EARLY),
    )
    values = label_values(labels, {"size": 0.15, "law": "implicit"}, NAMES, ROWS)
    assert values == {"good": True, "over": True, "rise": 0.2, "early": 0.1}
    assert list(values) == ["good", "over", "rise", "early"]
    assert (RISE.unit, HEIGHT.is_series, labels[0].unit) == ("m", True, None)


def test_a_parameter_that_is_no_number_has_no_place_in_arithmetic() -> None:
    with pytest.raises(ExpressionError, match="needs a number: law is none"):
        label_values((expressed("wrong", "law + 1"),), {"law": "implicit"}, NAMES, ROWS)


def test_which_trajectories_are_kept() -> None:
    keep = parse_expression("rise > size")
    assert is_kept(keep, {"size": 0.1}, {"rise": 0.2})
    assert not is_kept(keep, {"size": 0.3}, {"rise": 0.2})
    assert is_kept(True, {}, {})
    assert not is_kept(False, {}, {})
