"""The runs of a sweep in which a label is largest or smallest, as a table of text."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from somo_cli.problems import did_you_mean
from somo_cli.sweep.expressions import ExpressionError, parse_expression
from somo_cli.sweep.label_values import is_kept
from somo_cli.sweep.one_run import Outcome
from somo_cli.sweep.study import Study

MOST = 10


def best_table(
    study: Study,
    outcomes: Mapping[int, Outcome],
    label: str,
    is_smallest: bool,
    where: str | None,
) -> Sequence[str]:
    """Return a header and up to ten rows: the run, its parameters and its labels.

    Raises ValueError for an unknown label or an expression that cannot be read.
    """
    labels = [one.name for one in study.labels if not one.is_series]
    if label not in labels:
        hint = did_you_mean(label, labels) or f"labels: {', '.join(labels)}"
        raise ValueError(f"there is no label '{label}'; {hint}")
    try:
        condition = True if where is None else parse_expression(where)
        kept = [
            number
            for number, one in sorted(outcomes.items())
            if _is_number(one.labels.get(label))
            and is_kept(condition, study.points[number], one.labels)
        ]
    except ExpressionError as error:
        raise ValueError(str(error)) from error
    kept.sort(key=lambda number: float(outcomes[number].labels[label]), reverse=not is_smallest)
    names = ["run", *(one.name for one in study.parameters), *labels]
    rows = [
        [str(number), *map(_text, _values(study, number, outcomes[number], labels))]
        for number in kept[:MOST]
    ]
    widths = [max(map(len, column)) for column in zip(names, *rows, strict=True)]
    return [
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in [names, *rows]
    ]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not math.isnan(value)


def _values(study: Study, number: int, outcome: Outcome, labels: Sequence[str]) -> list[object]:
    point = study.points[number]
    return [
        *(point[one.name] for one in study.parameters),
        *(outcome.labels.get(name, "") for name in labels),
    ]


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.6g}" if isinstance(value, float) else str(value)
