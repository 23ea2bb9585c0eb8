"""Read a study: its shape by the schema, then its paths, columns and expressions by the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, cast

from somo_cli.document.parse import Document
from somo_cli.document.table import Table
from somo_cli.document.validate import schema_problems
from somo_cli.problems import InvalidFile, Problem, SomoError, in_reading_order
from somo_cli.scene.checks.recording import select_by_patterns
from somo_cli.scene.model import Scene, is_scene
from somo_cli.scene.pose_table import TIME
from somo_cli.sweep import label_reader, parameter_reader, points
from somo_cli.sweep.expressions import Expression
from somo_cli.sweep.study import SAMPLED, Combination, Label, Parameter, Point, Study


def shape_problems(document: Document) -> tuple[Problem, ...]:
    """Return how a document does not fit the schema of a study."""
    if is_scene(document):
        hint = "a study names it as its scene"
        return (Problem(document.span(()), "this is a scene, not a study", hint),)
    found = [one.problem for one in schema_problems(document, "study")]
    if not found:
        found += _conflicts(document)
    return in_reading_order(found, document.texts)


def _conflicts(document: Document) -> Iterator[Problem]:
    data = cast(Mapping[str, Any], document.data)
    if "duration" in data and "steps" in data:
        place = document.span(("steps",), key=True)
        hint = "give the simulated time in seconds as duration"
        yield Problem(place, "duration and steps exclude each other", hint)
    combine = data.get("combine", "grid")
    is_random = combine in SAMPLED
    if is_random and "count" not in data:
        yield Problem(document.span(("combine",)), f"{combine} needs a count", "how many sets")
    for key in ("count", "seed"):
        if key in data and not is_random:
            hint = "it is for combine: random, latin_hypercube or sobol"
            yield Problem(document.span((key,), key=True), f"{key} has no effect", hint)


def read_study(document: Document, scene: Document, found: Scene, table: Table | None) -> Study:
    """Return the study of a document that fits the schema.

    `scene` is the document of its scene with all files included, `found` that scene, and `table`
    the one that `combine` names. Raises InvalidFile with every error.
    """
    data = cast(Mapping[str, Any], document.data)
    problems: list[Problem] = []
    if not {"duration", "steps"} & data.keys() and found.duration is None:
        hint = "give the simulated time in seconds as duration, here or in the scene"
        problems.append(Problem(document.span(()), "there is no duration", hint))
    parameters = parameter_reader.parameters(document, scene, table, problems)
    labels = label_reader.labels(document, [one.name for one in parameters], problems)
    problems += _column_problems(document, labels, found)
    keep = _keep(document, data.get("keep", "none"), labels, parameters, problems)
    combination, sets = _points(document, parameters, table, problems)
    if problems:
        raise InvalidFile(in_reading_order(problems, document.texts), document.texts)
    return Study(
        data["scene"],
        parameters,
        labels,
        sets,
        combination,
        data.get("steps"),
        data.get("duration", None if "steps" in data else found.duration),
        data.get("time_out"),
        keep,
        bool(data.get("error", False)),
    )


def _column_problems(
    document: Document, labels: tuple[Label, ...], found: Scene
) -> Iterator[Problem]:
    """Yield a problem for each label of a column that the scene does not have."""
    for one in labels:
        if one.column in (None, TIME):
            continue
        place = document.span(("labels", one.name, "of"))
        if any(character in one.column for character in "*?["):
            yield Problem(place, f"'{one.column}' is a pattern", "give the name of one column")
            continue
        try:
            select_by_patterns(found, [one.column])
        except ValueError as error:
            message, _, hint = str(error).partition("; ")
            yield Problem(place, message, hint)


def _keep(
    document: Document,
    text: str,
    labels: tuple[Label, ...],
    parameters: tuple[Parameter, ...],
    problems: list[Problem],
) -> bool | Expression:
    if text in ("all", "none"):
        return text == "all"
    names = {one.name for one in labels} | {one.name for one in parameters}
    expression = label_reader.checked_expression(document, ("keep",), text, names, problems)
    return expression or False


def _points(
    document: Document,
    parameters: tuple[Parameter, ...],
    table: Table | None,
    problems: list[Problem],
) -> tuple[Combination, tuple[Point, ...]]:
    data = cast(Mapping[str, Any], document.data)
    named = data.get("combine", "grid")
    combination = cast(Combination, "table" if isinstance(named, dict) else named)
    if problems:
        return combination, ()
    rows = _rows(table, parameters)
    count = len(rows) if combination == "table" else data.get("count", 0)
    total = points.number_of_points(parameters, combination, count)
    place = document.span(("parameters",), key=True)
    if total > points.MAX_POINTS:
        problems.append(Problem(place, f"these are {total} runs, more than {points.MAX_POINTS}"))
        return combination, ()
    try:
        return combination, points.combined(
            parameters, combination, count, data.get("seed", 0), rows
        )
    except SomoError as error:
        problems.append(Problem(place, str(error)))
    return combination, ()


def _rows(table: Table | None, parameters: tuple[Parameter, ...]) -> list[tuple[float, ...]]:
    """Return the rows of a table; whole numbers are integers, which a scene may ask for."""
    if table is None:
        return []
    names = [one.name for one in parameters if one.expression is None]
    columns = (map(points.whole_as_integer, table.columns[name]) for name in names)
    return list(zip(*columns, strict=True))
