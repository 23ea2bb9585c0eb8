"""The labels of a study: what is taken of a column, and expressions over labels."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, cast

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem, did_you_mean
from somo_cli.sweep.expressions import Expression, ExpressionError, parse_expression
from somo_cli.sweep.names import name_problems
from somo_cli.sweep.reductions import NEEDS, Options
from somo_cli.sweep.study import Label

_OPTIONS = ("at", "level", "within", "period")


def labels(
    document: Document, parameters: Sequence[str], problems: list[Problem]
) -> tuple[Label, ...]:
    """Return the labels in an order in which each has what it needs; problems are added."""
    given = cast(Mapping[str, Any], cast(Any, document.data)["labels"])
    known = {*parameters, *given}
    found: list[Label] = []
    for name, data in given.items():
        pointer = ("labels", name)
        problems += name_problems(document, pointer)
        if name in parameters:
            place = document.span(pointer, key=True)
            problems.append(Problem(place, f"'{name}' is a parameter as well"))
        if isinstance(data, str):
            expression = checked_expression(document, pointer, data, known, problems)
            found.append(Label(name, expression=expression))
        else:
            problems += _option_problems(document, pointer, data)
            found.append(_column_label(name, data))
    return _in_order(document, found, set(parameters), problems)


def checked_expression(
    document: Document,
    pointer: Pointer,
    text: str,
    known: Collection[str] | None,
    problems: list[Problem],
) -> Expression | None:
    """Return an expression, or None and a problem; names are checked if `known` are given."""
    try:
        found = parse_expression(text)
    except ExpressionError as error:
        problems.append(Problem(document.span(pointer), str(error), f"in '{text}'"))
        return None
    if known is not None:
        check_names(document, pointer, found, known, problems)
    return found


def check_names(
    document: Document,
    pointer: Pointer,
    expression: Expression,
    known: Collection[str],
    problems: list[Problem],
) -> None:
    """Add a problem for each name of an expression that is not known."""
    for name in sorted(expression.names - set(known)):
        hint = did_you_mean(name, known) or f"names: {', '.join(sorted(known))}"
        problems.append(Problem(document.span(pointer), f"there is no '{name}'", hint))


def _column_label(name: str, data: Mapping[str, Any]) -> Label:
    options = Options(**{key: float(data[key]) for key in _OPTIONS if key in data})
    after, before = data.get("after"), data.get("before")
    return Label(name, data["of"], data.get("take"), after, before, options)


def _option_problems(
    document: Document, pointer: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    take = data.get("take")
    needed = NEEDS.get(take or "")
    if needed is not None and needed not in data:
        place = document.span((*pointer, "take"))
        yield Problem(place, f"{take} needs a key '{needed}' beside it")
    for key in _OPTIONS:
        if key in data and key != needed:
            place = document.span((*pointer, key), key=True)
            which = ", ".join(name for name, option in NEEDS.items() if option == key)
            yield Problem(place, f"'{key}' has no effect", f"it is for take: {which}")


def _in_order(
    document: Document, found: Sequence[Label], known: set[str], problems: list[Problem]
) -> tuple[Label, ...]:
    """Return the labels as they stand, if each expression can be computed before it is needed."""
    done = known | {one.name for one in found if one.expression is None}
    waiting = [one for one in found if one.expression is not None]
    names = {one.name for one in found} | known
    while waiting:
        ready = [one for one in waiting if one.expression and one.expression.names & names <= done]
        if not ready:
            place = document.span(("labels", waiting[0].name))
            problems.append(Problem(place, f"'{waiting[0].name}' depends on itself"))
            break
        done |= {one.name for one in ready}
        waiting = [one for one in waiting if one not in ready]
    return tuple(found)
