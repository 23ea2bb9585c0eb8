"""The table of a sweep, with the spacing of its parameters and the units of its labels."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from somo_cli.document.csv_cells import values_of
from somo_cli.problems import LINE_BREAK, InvalidFile, Problem, Span, did_you_mean

OUTCOME = ("run", "status", "findings", "reason", "run_time_s")


@dataclass(frozen=True, slots=True)
class SweepTable:
    """The texts of a table, a row each; `spacings` and `units` by name, where they are known."""

    names: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    spacings: Mapping[str, str]
    units: Mapping[str, str]

    def column(self, name: str) -> tuple[str, ...]:
        """Return a column; raise ValueError, with a hint, if there is none of this name."""
        if name not in self.names:
            known = [one for one in self.names if one not in OUTCOME]
            hint = did_you_mean(name, known) or f"columns: {', '.join(known)}"
            raise ValueError(f"there is no column '{name}'; {hint}")
        place = self.names.index(name)
        return tuple(row[place] for row in self.rows)

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the parameters, where `study.json` is beside the table."""
        return tuple(self.spacings)

    def where(self, name: str, value: str) -> SweepTable:
        """Return the rows in which a column has a value; raise ValueError if none has."""
        texts = self.column(name)
        kept = [row for row, text in zip(self.rows, texts, strict=True) if _are_alike(text, value)]
        if not kept:
            known = ", ".join(dict.fromkeys(texts))
            raise ValueError(f"no row has {name}={value}; values: {known}")
        return SweepTable(self.names, tuple(kept), self.spacings, self.units)


def number_of(text: str) -> float:
    """Return the number of a cell, 1 and 0 for true and false, NaN for what is none."""
    if text in ("true", "false"):
        return float(text == "true")
    try:
        return float(text)
    except ValueError:
        return math.nan


def is_class(texts: Sequence[str]) -> bool:
    """Return whether cells name classes, such as true and false, rather than numbers."""
    return any(text and math.isnan(number_of(text)) for text in texts) or set(texts) <= {
        *("true", "false", "")
    }


def read_sweep_table(text: str, source: str, about: str | None) -> SweepTable:
    """Return the table in a text, and what `study.json`, if it is given, says of it.

    Raises InvalidFile for rows that are longer or shorter than the header.
    """
    lines = [line for line in LINE_BREAK.split(text) if line.strip()]
    if not lines:
        raise InvalidFile([Problem(Span(source, 1, 1), "the file is empty")], {source: text})
    names = tuple(values_of(lines[0]))
    rows = [tuple(values_of(line)) for line in lines[1:]]
    for number, row in enumerate(rows, start=2):
        if len(row) != len(names):
            message = f"this row has {len(row)} cells, the header {len(names)}"
            raise InvalidFile([Problem(Span(source, number, 1), message)], {source: text})
    spacings, units = {}, {}
    if about is not None:
        try:
            data = json.loads(about)
            spacings = {one["name"]: one["spacing"] for one in data["parameters"]}
            units = {one["name"]: one["unit"] or "" for one in data["labels"]}
        except (ValueError, KeyError, TypeError):
            pass  # the table says enough for a plot
    return SweepTable(names, tuple(rows), spacings, units)


def _are_alike(text: str, value: str) -> bool:
    number = number_of(value)
    return text == value or (not math.isnan(number) and number_of(text) == number)
