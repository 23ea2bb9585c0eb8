"""Arithmetic of a study: expressions over parameters and labels, without `eval`.

There are numbers, names, + - * / ** %, comparisons, `and`, `or`, `not`, `a if b else c`, and the
functions of `FUNCTIONS`. All numbers are floats, so no power takes long; true and false are values
of comparisons.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from somo_cli.problems import SomoError
from somo_cli.sweep.reductions import REDUCTIONS, Series, reduced

Value: TypeAlias = float | bool
Known: TypeAlias = Mapping[str, "Value | Series"]

MAX_LENGTH = 1000
"""The most characters of an expression."""
CONSTANTS = {"pi": math.pi, "true": True, "false": False, "True": True, "False": False}
FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs,
    "round": round,
    "floor": math.floor,
    "ceil": math.ceil,
    "min": min,
    "max": max,
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "hypot": math.hypot,
}
_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.Mod: operator.mod,
}
_UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
}
_COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


class ExpressionError(SomoError):
    """An expression that cannot be read, or has no value; `column` counts characters from 0."""

    def __init__(self, message: str, column: int = 0) -> None:
        super().__init__(message)
        self.column = column


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression that was read, and the names that it needs."""

    text: str
    names: frozenset[str]
    _body: ast.expr

    def value(self, known: Known) -> Value:
        """Return the value, given those of all names.

        Raises ExpressionError if it has none, such as for a division by zero.
        """
        try:
            found = _value(self._body, known)
        except ZeroDivisionError as error:
            raise ExpressionError(f"'{self.text}' divides by zero") from error
        except OverflowError as error:
            raise ExpressionError(f"'{self.text}' is too large") from error
        except ValueError as error:
            raise ExpressionError(f"'{self.text}' is not defined: {error}") from error
        if isinstance(found, Series):
            raise ExpressionError(f"'{self.text}' is a column, not a number: take its max or last")
        if isinstance(found, complex):
            raise ExpressionError(f"'{self.text}' is not a real number")
        return bool(found) if isinstance(found, bool) else float(found)


def parse_expression(text: str) -> Expression:
    """Return the expression in a text; raise ExpressionError with the column of what is wrong."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"the expression is longer than {MAX_LENGTH} characters")
    try:
        body = ast.parse(text, mode="eval").body
    except SyntaxError as error:
        raise ExpressionError(
            "this is not an expression", max(0, (error.offset or 1) - 1)
        ) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise ExpressionError("this is not an expression") from error
    names: set[str] = set()
    _check(body, names)
    return Expression(text, frozenset(names), body)


def _check(node: ast.expr, names: set[str]) -> None:
    """Collect the names of an expression; raise ExpressionError for what is not arithmetic."""
    functions: set[str] = set()
    for part in ast.walk(node):
        match part:
            case ast.Constant(value=bool() | int() | float()):
                pass
            case ast.Call(func=ast.Name(id=name)):
                _check_call(part, name)
                functions.add(name)
            case ast.Name(id=name):
                names.add(name)
            case ast.BinOp() | ast.UnaryOp() | ast.BoolOp() | ast.Compare() | ast.IfExp():
                _check_operators(part)
            case ast.expr():
                message = "only numbers, names, arithmetic, comparisons and functions are known"
                raise ExpressionError(message, part.col_offset)
    names -= functions | CONSTANTS.keys()


def _check_call(call: ast.Call, name: str) -> None:
    if name not in FUNCTIONS and name not in REDUCTIONS:
        known = ", ".join(sorted({*FUNCTIONS, *REDUCTIONS}))
        raise ExpressionError(f"there is no function '{name}'; there are {known}", call.col_offset)
    if call.keywords or any(isinstance(one, ast.Starred) for one in call.args):
        raise ExpressionError(f"{name}() takes values alone", call.col_offset)
    if not call.args:
        raise ExpressionError(f"{name}() needs a value", call.col_offset)


def _check_operators(part: ast.expr) -> None:
    known = (*_BINARY, *_UNARY, *_COMPARISONS, ast.And, ast.Or)
    operators = [getattr(part, "op", None), *getattr(part, "ops", [])]
    if any(one is not None and not isinstance(one, known) for one in operators):
        raise ExpressionError("only + - * / ** % and comparisons are known", part.col_offset)


def _value(node: ast.expr, known: Known) -> Any:
    match node:
        case ast.Constant(value=bool() as value):
            return value
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.Name(id=name):
            return CONSTANTS[name] if name in CONSTANTS else known[name]
        case ast.BinOp():
            return _BINARY[type(node.op)](_value(node.left, known), _value(node.right, known))
        case ast.UnaryOp():
            return _UNARY[type(node.op)](_value(node.operand, known))
        case ast.BoolOp():
            is_all = isinstance(node.op, ast.And)
            values = (bool(_value(one, known)) for one in node.values)
            return all(values) if is_all else any(values)
        case ast.IfExp():
            return _value(node.body if _value(node.test, known) else node.orelse, known)
        case ast.Compare():
            return _compared(node, known)
        case ast.Call(func=ast.Name(id=name)):
            return _called(name, [_value(one, known) for one in node.args])
    raise AssertionError(ast.dump(node))


def _compared(node: ast.Compare, known: Known) -> bool:
    values = [_value(one, known) for one in (node.left, *node.comparators)]
    return all(
        _COMPARISONS[type(one)](first, second)
        for one, first, second in zip(node.ops, values, values[1:], strict=False)
    )


def _called(name: str, values: list[Any]) -> float:
    if len(values) == 1 and isinstance(values[0], Series):
        if name not in REDUCTIONS:
            raise ExpressionError(f"{name}() of a column is not known")
        return reduced(values[0], name)
    if name not in FUNCTIONS:
        raise ExpressionError(f"{name}() needs a column")
    if name in ("min", "max") and len(values) == 1:
        return float(values[0])
    try:
        return float(FUNCTIONS[name](*values))
    except TypeError as error:
        raise ExpressionError(f"{name}() does not take these values") from error
