"""Text of files as a terminal can show it: escaped, cut to a width, with carets below."""

from __future__ import annotations

import re
import unicodedata

_MAX_CHARACTERS = 2000  # characters of a message
_MAX_COLUMNS = 100  # columns of a source line
# GitHub's log viewer would run such lines as commands, blanks in front or not
_COMMAND = re.compile(r"^\s*(?P<double>:)(?=:)|(?P<hash>#)(?=#\[)")


def excerpt(line: str, column: int, width: int) -> tuple[str, str]:
    """Return the part of a line around a column, and the carets under it.

    A line may be a megabyte long, so it is cut roughly before its width is measured.
    """
    start = max(0, column - _MAX_COLUMNS)
    cells = _cells(line[start : column + _MAX_COLUMNS + 1])
    widths = [_width(cell) for cell in cells]
    column -= start
    first = 0 if start else min(len(line) - len(line.lstrip()), column)
    last = len(cells)
    before = after = ""
    if start or sum(widths[first:]) > _MAX_COLUMNS:
        room = _MAX_COLUMNS - len("...  ...")
        indent, first = first, max(first, _first_that_fits(widths, column, room // 2))
        last = _last_that_fits(widths, first, room)
        before = "... " if start or first > indent else ""
        after = " ..." if last < len(cells) or len(cells) < len(line) - start else ""
    shown = "".join(cells[first:last]).rstrip()
    carets = "^" * max(1, sum(widths[column : min(column + width, last)]))
    return before + shown + after, " " * (len(before) + sum(widths[first:column])) + carets


def _first_that_fits(widths: list[int], column: int, room: int) -> int:
    while column > 0 and room >= widths[column - 1]:
        column -= 1
        room -= widths[column]
    return column


def _last_that_fits(widths: list[int], first: int, room: int) -> int:
    while first < len(widths) and room >= widths[first]:
        room -= widths[first]
        first += 1
    return first


def escaped(text: str) -> str:
    """Return a text without characters that would do anything but show, cut to a length."""
    return "".join(
        _cells(text if len(text) <= _MAX_CHARACTERS else text[:_MAX_CHARACTERS] + " ...")
    )


def _cells(line: str) -> list[str]:
    """Return what is shown for each character of a line."""
    cells = [" " if c == "\t" else c if c.isprintable() else _escape(c) for c in line]
    for match in _COMMAND.finditer(line):
        index = match.start(match.lastgroup or 0)
        cells[index] = f"\\x{ord(line[index]):02x}"
    return cells


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


def _width(cell: str) -> int:
    """Return the width of a cell in columns of a terminal."""
    if len(cell) > 1:
        return len(cell)
    if unicodedata.combining(cell):
        return 0
    return 2 if unicodedata.east_asian_width(cell) in "WF" else 1
