"""Tables of numbers under a header, read from CSV, with the position of every cell."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import compress, dropwhile
from operator import not_

from somo_cli.document.csv_cells import cells_of, line_span, plain_numbers, values_of
from somo_cli.problems import (
    LINE_BREAK,
    MAX_NUMBER,
    InvalidFile,
    Problem,
    Span,
    counted,
    did_you_mean,
    shortened,
)

MAX_PROBLEMS = 20
"""The most problems of one file that are reported: most rows often have the same one."""

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?(?:inf|infinity|nan)", re.IGNORECASE)
_OTHER_SEPARATOR = re.compile(r"\S\s*?([;\t])")
_POINT = "are these decimal commas? write 0.5, not 0,5"


@dataclass(frozen=True, slots=True)
class Table:
    """Columns of finite numbers, the text they were written in, and the line of each row.

    The first of the `lines` is that of the header; they count from 1.
    """

    source: str
    text: str
    names: tuple[str, ...]
    columns: Mapping[str, tuple[float, ...]]
    lines: tuple[int, ...]

    @property
    def texts(self) -> Mapping[str, str]:
        """The text by its source, as InvalidFile takes it."""
        return {self.source: self.text}

    def header_span(self, name: str) -> Span:
        """Return the position of the name of a column; raise ValueError for an unknown name."""
        return self._span(self.lines[0], name)

    def cell_span(self, row: int, name: str) -> Span:
        """Return the position of a number; row 0 is the first under the header."""
        return self._span(self.lines[1:][row], name)

    def _span(self, line: int, name: str) -> Span:
        cells = cells_of(LINE_BREAK.split(self.text)[line - 1])
        return cells[self.names.index(name)].span(self.source, line)


def read_table(text: str, source: str) -> Table:
    """Return the table in a CSV text: a header with the column names, then rows of finite numbers.

    Blank lines, and lines that start with '#' above the header, are skipped. Raises InvalidFile
    with the first MAX_PROBLEMS problems.
    """
    text = text.removeprefix("\ufeff")
    texts = {source: text}
    lines = _lines(text)
    if not lines:
        raise InvalidFile([Problem(Span(source, 1, 1), "the file is empty")], texts)
    (top, header), rows = lines[0], lines[1:]
    names = tuple(cell.value for cell in cells_of(header))
    numbers = [plain_numbers(line) for _, line in rows]
    problems = _separator_problems(header, Span(source, top, 1))
    if not problems:
        problems = _name_problems(header, Span(source, top, 1))
        if not rows:
            message = "no row follows the header"
            problems.append(Problem(line_span(header, Span(source, top, 1)), message))
        is_sound = [len(values) == len(names) for values in numbers]
        most = MAX_PROBLEMS - len(problems)
        problems.extend(_row_problems(rows, is_sound, len(names), source, most))
    if problems:
        raise InvalidFile(problems[:MAX_PROBLEMS], texts)
    for index, (_, line) in enumerate(rows):
        numbers[index] = numbers[index] or [float(value) for value in values_of(line)]
    columns = dict(zip(names, zip(*numbers, strict=True), strict=True))
    return Table(source, text, names, columns, tuple(number for number, _ in lines))


def table_problems(
    table: Table,
    wanted: Sequence[str] = (),
    increasing: str | None = None,
    least: int = 0,
    why: str = "",
) -> list[Problem]:
    """Return a problem for everything that a table lacks.

    It must have the `wanted` columns, and the one that must increase from row to row. It must have
    at least `least` rows, since `why` needs them ("a fit").
    """
    columns = dict.fromkeys([*wanted] if increasing is None else [*wanted, increasing])
    header = LINE_BREAK.split(table.text)[table.lines[0] - 1]
    place = line_span(header, Span(table.source, table.lines[0], 1))
    problems = [
        Problem(place, f"there is no column '{name}'", _known_columns_hint(name, table.names))
        for name in columns
        if name not in table.columns
    ]
    found = len(table.lines) - 1
    if found < least:
        message = f"{counted(found, 'row')}, but {why} needs at least {least}"
        problems.append(Problem(place, message))
    if increasing is not None and increasing in table.columns:
        problems.extend(_order_problems(table, increasing))
    return problems


def require_columns(
    table: Table,
    wanted: Sequence[str] = (),
    increasing: str | None = None,
    least: int = 0,
    why: str = "",
) -> None:
    """Raise InvalidFile with what `table_problems` returns, if it returns any problem."""
    problems = table_problems(table, wanted, increasing, least, why)
    if problems:
        raise InvalidFile(problems, table.texts)


def _lines(text: str) -> list[tuple[int, str]]:
    """Return the header and the rows, each line with its number, from 1."""
    lines = [each for each in enumerate(LINE_BREAK.split(text), start=1) if each[1].strip()]
    return list(dropwhile(lambda each: each[1].lstrip().startswith("#"), lines))


def _separator_problems(header: str, place: Span) -> list[Problem]:
    if "," in header:
        return []
    found = _OTHER_SEPARATOR.search(header.rstrip())
    if not found:
        return []
    span = Span(place.source, place.line, found.end())
    called = "a tab" if found[1] == "\t" else f"'{found[1]}'"
    message = f"the columns must be separated by commas, found {called}"
    return [Problem(span, message, "numbers have a point, as in 0.5,1.2")]


def _name_problems(header: str, place: Span) -> list[Problem]:
    cells = cells_of(header)
    if all(_NUMBER.fullmatch(cell.value) for cell in cells):
        hint = "name the columns in the first line that does not start with '#'"
        return [Problem(line_span(header, place), "the columns have no names", hint)]
    problems = []
    first: dict[str, int] = {}
    for cell in cells:
        span = cell.span(place.source, place.line)
        if not cell.value:
            problems.append(Problem(span, "this column has no name", "name it, or drop the comma"))
        elif cell.value in first:
            message = f"two columns are named '{shortened(cell.value)}'"
            hint = f"the first one starts in column {first[cell.value]} of this line"
            problems.append(Problem(span, message, hint))
        first.setdefault(cell.value, cell.column)
    return problems


def _row_problems(
    rows: Sequence[tuple[int, str]],
    is_sound: Sequence[bool],
    wanted: int,
    source: str,
    most: int,
) -> list[Problem]:
    problems: list[Problem] = []
    hint = _POINT if all(len(values_of(line)) > wanted for _, line in rows) else ""
    for number, line in compress(rows, map(not_, is_sound)):
        if len(problems) >= most:
            break
        place = Span(source, number, 1)
        found = len(values_of(line))
        if found != wanted:
            message = f"{counted(found, 'cell')}, but the header names {counted(wanted, 'column')}"
            problems.append(Problem(line_span(line, place), message, hint))
        else:
            problems.extend(_cell_problems(line, place))
    return problems[: max(0, most)]


def _cell_problems(line: str, place: Span) -> Iterator[Problem]:
    if all(map(_is_number, values_of(line))):
        return
    for cell in cells_of(line):
        if _is_number(cell.value):
            continue
        span = cell.span(place.source, place.line)
        if not cell.value:
            yield Problem(span, "this cell is empty", "write a number")
        elif _NUMBER.fullmatch(cell.value) and math.isfinite(float(cell.value)):
            hint = f"no number may be larger than {MAX_NUMBER:g}"
            yield Problem(span, f"{shortened(cell.value)} is too large", hint)
        elif _NUMBER.fullmatch(cell.value) or _NOT_FINITE.fullmatch(cell.value):
            message = f"not a finite number: {shortened(cell.value)}"
            yield Problem(span, message, "write an ordinary number, or leave the row out")
        else:
            yield Problem(span, f"not a number: {shortened(cell.value)!r}", "write it like 0.5")


def _is_number(value: str) -> bool:
    return _NUMBER.fullmatch(value) is not None and abs(float(value)) <= MAX_NUMBER


def _order_problems(table: Table, name: str) -> Iterator[Problem]:
    values = table.columns[name]
    rows = [row for row in range(1, len(values)) if values[row] <= values[row - 1]]
    if rows:
        first = rows[0]
        message = f"'{name}' must increase, found {values[first]} after {values[first - 1]}"
        more = f", and so in {counted(len(rows) - 1, 'more row')}" if len(rows) > 1 else ""
        hint = f"each '{name}' must be greater than the one above it"
        yield Problem(table.cell_span(first, name), message + more, hint)


def _known_columns_hint(name: str, known: Sequence[str]) -> str:
    return did_you_mean(name, known) or f"known columns: {', '.join(known)}"
