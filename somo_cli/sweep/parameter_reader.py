"""The parameters of a study: their values, and the places in the scene that they set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, cast

from somo_cli.document.parse import Document
from somo_cli.document.table import Table
from somo_cli.problems import Pointer, Problem, did_you_mean
from somo_cli.sweep import label_reader, points, targets
from somo_cli.sweep.names import name_problems
from somo_cli.sweep.study import SAMPLED, Parameter, Spacing

_SOURCES = ("values", "range", "log", "expression")
_SPACINGS: Mapping[str, Spacing] = {"values": "values", "range": "linear", "log": "log"}


def parameters(
    document: Document, scene: Document, table: Table | None, problems: list[Problem]
) -> tuple[Parameter, ...]:
    """Return the parameters; problems are added to the list."""
    given = cast(Mapping[str, Mapping[str, Any]], cast(Any, document.data)["parameters"])
    combine = cast(Any, document.data).get("combine", "grid")
    for name in given:
        problems += name_problems(document, ("parameters", name))
    found = [
        _parameter(document, scene, name, data, combine, problems) for name, data in given.items()
    ]
    problems += _table_problems(document, found, table)
    problems += _unequal_lengths(document, found, combine)
    names = {one.name for one in found}
    for one in found:
        if one.expression is not None:
            place = ("parameters", one.name, "expression")
            label_reader.check_names(document, place, one.expression, names, problems)
    return tuple(found)


def _parameter(
    document: Document,
    scene: Document,
    name: str,
    data: Mapping[str, Any],
    combine: object,
    problems: list[Problem],
) -> Parameter:
    pointer = ("parameters", name)
    pointers = _targets(document, scene, pointer, data.get("path", ()), problems)
    sources = [key for key in _SOURCES if key in data]
    is_from_table = isinstance(combine, dict) and "expression" not in data
    if is_from_table:
        problems += (
            Problem(document.span((*pointer, key), key=True), "the table has the values")
            for key in sources
        )
        return Parameter(name, pointers, "values")
    if len(sources) != 1:
        message = f"'{name}' needs one of {', '.join(_SOURCES)}, and has {len(sources)}"
        problems.append(Problem(document.span(pointer, key=True), message))
        return Parameter(name, pointers, "values", (0.0,))
    (source,) = sources
    if source == "expression":
        place = (*pointer, source)
        expression = label_reader.checked_expression(document, place, data[source], None, problems)
        return Parameter(name, pointers, "expression", expression=expression)
    if source == "values":
        return Parameter(name, pointers, "values", tuple(data[source]))
    return _spaced(document, name, pointers, data[source], source, combine, problems)


def _spaced(
    document: Document,
    name: str,
    pointers: tuple[Pointer, ...],
    span: Mapping[str, Any],
    source: str,
    combine: object,
    problems: list[Problem],
) -> Parameter:
    pointer = ("parameters", name, source)
    first, last, is_log = float(span["from"]), float(span["to"]), source == "log"
    if is_log and first * last <= 0:
        problems.append(
            Problem(document.span(pointer), "the ends of log need the same sign, and not 0")
        )
        return Parameter(name, pointers, "log", (1.0,))
    if combine in SAMPLED:
        if "count" in span:
            place = document.span((*pointer, "count"), key=True)
            problems.append(Problem(place, "random sets have one count, that of the study"))
        return Parameter(name, pointers, "random", bounds=(first, last), is_log=is_log)
    if "count" not in span:
        hint = "how many values there are"
        problems.append(Problem(document.span(pointer), "missing key 'count'", hint))
        return Parameter(name, pointers, _SPACINGS[source], (first,))
    values = points.spaced(first, last, span["count"], is_log)
    if isinstance(span["from"], int) and all(value.is_integer() for value in values):
        values = tuple(map(points.whole_as_integer, values))  # such as numbers of segments
    return Parameter(name, pointers, _SPACINGS[source], values)


def _targets(
    document: Document,
    scene: Document,
    pointer: Pointer,
    path: str | Sequence[str],
    problems: list[Problem],
) -> tuple[Pointer, ...]:
    is_one = isinstance(path, str)
    paths = [path] if is_one else path
    found: list[Pointer] = []
    for index, text in enumerate(paths):
        place = (*pointer, "path") if is_one else (*pointer, "path", index)
        try:
            found += targets.pointers_of(scene, cast(str, text))
        except targets.TargetError as error:
            problems.append(Problem(document.span(place), str(error), error.hint))
    return tuple(dict.fromkeys(found))


def _table_problems(
    document: Document, found: Sequence[Parameter], table: Table | None
) -> Iterator[Problem]:
    if table is None:
        return
    for one in found:
        if one.expression is None and one.name not in table.columns:
            place = document.span(("parameters", one.name), key=True)
            known = table.names
            hint = did_you_mean(one.name, known) or f"columns: {', '.join(known)}"
            yield Problem(place, f"{table.source} has no column '{one.name}'", hint)


def _unequal_lengths(
    document: Document, found: Sequence[Parameter], combine: object
) -> Iterator[Problem]:
    if combine != "zip":
        return
    counts = {one.name: len(one.values) for one in found if one.values}
    if len(set(counts.values())) > 1:
        told = ", ".join(f"{name} {count}" for name, count in counts.items())
        place = document.span(("combine",))
        yield Problem(place, f"zip needs as many values of each parameter: {told}")
