"""A line of a CSV to its cells, with the position of each."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from somo_cli.problems import MAX_NUMBER, Span

_CELL = re.compile(r'[ \t]*(?:"(?P<quoted>(?:[^"]|"")*)"[ \t]*(?=,|$)|(?P<plain>[^,]*))')
_PLAIN_ROW = re.compile(r"[-+.,0-9eE \t]+")


@dataclass(frozen=True, slots=True)
class Cell:
    """The text of a cell without quotes, and its column and width in the line, from 1."""

    value: str
    column: int
    width: int

    def span(self, source: str, line: int) -> Span:
        """Return the span of the cell in a line of a source."""
        return Span(source, line, self.column, max(1, self.width))


def cells_of(line: str) -> list[Cell]:
    """Return the cells of a line, with their positions."""
    cells = []
    end = -1
    while end < len(line):
        match = _CELL.match(line, end + 1)
        assert match, "an empty cell matches too"
        quoted = match["quoted"]
        if quoted is None:
            plain = match["plain"]
            value = plain.strip()
            column, width = match.end() - len(plain.lstrip()) + 1, len(value)
        else:
            value = quoted.replace('""', '"').strip()
            column, width = match.start("quoted"), len(quoted) + 2  # with its quotes
        cells.append(Cell(value, column, width))
        end = match.end()
    return cells


def values_of(line: str) -> list[str]:
    """Return the texts of the cells of a line."""
    if '"' in line:  # in few lines
        return [cell.value for cell in cells_of(line)]
    return [value.strip() for value in line.split(",")]


def plain_numbers(line: str) -> list[float]:
    """Return the numbers of a row that has nothing else; empty if its cells must be examined."""
    if not _PLAIN_ROW.fullmatch(line):
        return []
    try:
        numbers = list(map(float, line.split(",")))
    except ValueError:
        return []
    # the sum is not finite if one of them is not
    is_sound = math.isfinite(sum(numbers)) and max(map(abs, numbers)) <= MAX_NUMBER
    return numbers if is_sound else []


def line_span(line: str, place: Span) -> Span:
    """Return the span of a whole line without the blanks around it; `place` is its start."""
    column = len(line) - len(line.lstrip()) + 1
    return Span(place.source, place.line, column, len(line.strip()))
