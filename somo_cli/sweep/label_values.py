"""The labels of one run, from its columns and its parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from somo_cli.arrays import Array
from somo_cli.sweep.expressions import Expression, ExpressionError, Value
from somo_cli.sweep.reductions import Series, reduced
from somo_cli.sweep.study import Label, Point


def label_values(
    labels: Sequence[Label], point: Point, names: Sequence[str], rows: Array
) -> dict[str, Value]:
    """Return the value of every label that is not a whole column.

    `rows` has shape (rows, columns), the time [s] first. Raises ExpressionError where an expression
    has no value.
    """
    known: dict[str, Value | Series] = dict(_numbers(point))
    values: dict[str, Value] = {}
    for one in labels:
        if one.column is None:
            continue
        series = Series(rows[:, 0], rows[:, names.index(one.column)])
        series = series.between(one.after, one.before)
        if one.take is None:
            known[one.name] = series
        else:
            known[one.name] = values[one.name] = reduced(series, one.take, one.options)
    waiting = {one.name: one.expression for one in labels if one.expression is not None}
    while waiting:
        name, expression = _next(waiting, known)
        known[name] = values[name] = expression.value(known)
        del waiting[name]
    return {one.name: values[one.name] for one in labels if one.name in values}


def is_kept(keep: bool | Expression, point: Point, values: Mapping[str, Value]) -> bool:
    """Return whether the trajectory of a run is kept; raises ExpressionError."""
    if isinstance(keep, bool):
        return keep
    known = {**_numbers(point), **values}
    _require(keep, known)
    return bool(keep.value(known))


def _numbers(point: Point) -> dict[str, Value]:
    return {name: value for name, value in point.items() if isinstance(value, int | float)}


def _next(waiting: Mapping[str, Expression], known: Mapping[str, object]) -> tuple[str, Expression]:
    """Return an expression of which all names are known."""
    for name, expression in waiting.items():
        if expression.names <= known.keys():
            return name, expression
    _require(next(iter(waiting.values())), known)
    raise AssertionError("some name is missing")


def _require(expression: Expression, known: Mapping[str, object]) -> None:
    missing = sorted(expression.names - known.keys())
    if missing:
        raise ExpressionError(f"'{expression.text}' needs a number: {', '.join(missing)} is none")
