"""What is printed for people: problems with their source lines, messages, progress, pages."""

from __future__ import annotations

import os
import re
import sys
import time
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress

from somo_cli import signals
from somo_cli.budget import Budget
from somo_cli.problems import LINE_BREAK, Problem

_MAX_COLUMNS = 100  # columns of a source line
_MAX_CHARACTERS = 2000  # characters of a message
_MAX_PROBLEMS = 500  # problems
_PAGE_WIDTH = 100  # columns of a page of the manual
_STYLES = {"error": "bold red", "warning": "bold yellow", "info": "bold blue"}
_REDRAW_INTERVAL = 0.1  # between two drawings of the progress bar [s]

# GitHub's log viewer would run such lines as commands, blanks in front or not
_COMMAND = re.compile(r"^\s*(?P<double>:)(?=:)|(?P<hash>#)(?=#\[)")


def print_problems(problems: Iterable[Problem], texts: Mapping[str, str]) -> None:
    """Write problems to standard error, each with its source line and a caret."""
    known = tuple(problems)
    lines: dict[str, list[str]] = {}
    written: list[tuple[str, str]] = []
    for problem in known[:_MAX_PROBLEMS]:
        source = problem.span.source
        if source not in lines:
            lines[source] = LINE_BREAK.split(texts.get(source, ""))
        written += _report(problem, lines[source])
    if len(known) > _MAX_PROBLEMS:
        written.append(("", f"and {len(known) - _MAX_PROBLEMS} more"))
    _write(written)


def print_message(message: str) -> None:
    """Write one line to standard error."""
    _write([("", _escaped(message))])


def print_lines(lines: Iterable[str]) -> None:
    """Write lines to standard error."""
    _write([("", _escaped(line)) for line in lines])


def show_page(markdown: str) -> None:
    """Write a page to standard output: laid out and paged on a terminal, else as it is."""
    if not sys.stdout.isatty() or os.environ.get("TERM") == "dumb":
        sys.stdout.write(markdown)
        return
    from rich.console import Console
    from rich.markdown import Markdown

    os.environ.setdefault("LESS", "-FRX")  # show colours, and a short page without paging
    console = Console(no_color=_is_colourless(), width=min(Console().width, _PAGE_WIDTH))
    with console.pager(styles=not _is_colourless()):
        console.print(Markdown(markdown, hyperlinks=False))


def has_bar() -> bool:
    """Return whether `progress` shows a bar."""
    return _is_terminal() and os.environ.get("TERM") != "dumb"


@contextmanager
def progress(
    total: int, description: str, budget: Budget | None = None
) -> Iterator[Callable[[int], None]]:
    """Show a progress bar on a terminal; yield the function that takes the number done so far.

    It also raises BudgetSpent, and again the exception of a signal that something has dropped.
    """
    guard = signals.guard_in_force()

    def end_if_due(done: int) -> None:
        if guard is not None:
            guard.raise_again()
        if budget is not None:
            budget.check(f"{description}: {done} of {total} done")

    if not has_bar():
        yield end_if_due
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.completed:.0f}/{task.total:.0f}"),
        TimeRemainingColumn(),
        console=Console(stderr=True, no_color=_is_colourless()),
        transient=True,
        redirect_stdout=False,
        redirect_stderr=False,
    )
    with bar:
        task = bar.add_task(_escaped(description), total=total)
        drawn = -_REDRAW_INTERVAL

        def advance(done: int) -> None:
            nonlocal drawn
            end_if_due(done)
            now = time.monotonic()
            # drawing the bar takes longer than a step of a simulation
            if now - drawn >= _REDRAW_INTERVAL or done >= total:
                drawn = now
                bar.update(task, completed=done)

        yield advance


def _report(problem: Problem, source: Sequence[str]) -> list[tuple[str, str]]:
    style = _STYLES[problem.severity]
    lines = [(style, _escaped(str(problem)))]
    span = problem.span
    written = source[span.line - 1] if 0 < span.line <= len(source) else ""
    if written.strip():
        line, carets = _excerpt(written, min(span.column - 1, len(written)), span.width)
        lines += [("", "    " + line), (style, "    " + carets)]
    if problem.hint:
        lines.append(("cyan", "  hint: " + _escaped(problem.hint)))
    return lines


def _excerpt(line: str, column: int, width: int) -> tuple[str, str]:
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


def _escaped(text: str) -> str:
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


def _is_terminal() -> bool:
    return sys.stderr is not None and not sys.stderr.closed and sys.stderr.isatty()


def _is_colourless() -> bool:
    return bool(os.environ.get("NO_COLOR")) or os.environ.get("TERM") == "dumb"


def _write(lines: Iterable[tuple[str, str]]) -> None:
    # an error in reporting an error would hide it
    if sys.stderr is None or sys.stderr.closed:
        return
    with suppress(OSError):
        if _is_terminal() and not _is_colourless():
            _write_coloured(lines)
        else:
            sys.stderr.write("".join(line + "\n" for _, line in lines))
        sys.stderr.flush()


def _write_coloured(lines: Iterable[tuple[str, str]]) -> None:
    from rich.console import Console
    from rich.text import Text

    console = Console(stderr=True, highlight=False)
    for style, line in lines:
        console.print(Text(line, style=style), soft_wrap=True)
