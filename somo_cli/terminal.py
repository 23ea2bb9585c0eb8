"""What is printed for people: problems with their source lines, messages, progress, pages."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress

from somo_cli import signals
from somo_cli.budget import Budget
from somo_cli.problems import LINE_BREAK, Problem
from somo_cli.terminal_text import escaped, excerpt

_MAX_PROBLEMS = 500  # problems
_PAGE_WIDTH = 100  # columns of a page of the manual
_STYLES = {"error": "bold red", "warning": "bold yellow", "info": "bold blue"}
_REDRAW_INTERVAL = 0.1  # between two drawings of the progress bar [s]
_LINE_INTERVAL = 10.0  # between two lines about progress, where there is no bar [s]


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
    _write([("", escaped(message))])


def print_lines(lines: Iterable[str]) -> None:
    """Write lines to standard error."""
    _write([("", escaped(line)) for line in lines])


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
    total: int,
    description: str,
    budget: Budget | None = None,
    remark: Callable[[], str] = str,
) -> Iterator[Callable[[int], None]]:
    """Show progress; yield the function that takes the number done so far.

    On a terminal it is a bar, elsewhere a line every ten seconds on standard error, which ends with
    the time that remains; `remark` returns what such a line says besides. The function also raises
    BudgetSpent, and again the exception of a signal that something has dropped.
    """
    guard = signals.guard_in_force()

    def end_if_due(done: int) -> None:
        if guard is not None:
            guard.raise_again()
        if budget is not None:
            budget.check(f"{description}: {done} of {total} done")

    if not has_bar():
        lines = _ProgressLines(total, description, remark)

        def report(done: int) -> None:
            end_if_due(done)
            lines.report_if_due(done)

        yield report
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
        task = bar.add_task(escaped(description), total=total)
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


class _ProgressLines:
    """Writes a line about progress when ten seconds have passed since the last one."""

    def __init__(self, total: int, description: str, remark: Callable[[], str]) -> None:
        self._total = total
        self._description = description
        self._remark = remark
        self._start = time.monotonic()
        self._last = self._start

    def report_if_due(self, done: int) -> None:
        """Write a line if one is due and the work is not done."""
        now = time.monotonic()
        if now - self._last < _LINE_INTERVAL or not 0 < done < self._total:
            return
        self._last = now
        remaining = (now - self._start) / done * (self._total - done)
        print_message(
            f"{self._description}: {done} of {self._total}{self._remark()}, "
            f"{remaining:.0f} s remain"
        )


def _report(problem: Problem, source: Sequence[str]) -> list[tuple[str, str]]:
    style = _STYLES[problem.severity]
    lines = [(style, escaped(str(problem)))]
    span = problem.span
    written = source[span.line - 1] if 0 < span.line <= len(source) else ""
    if written.strip():
        line, carets = excerpt(written, min(span.column - 1, len(written)), span.width)
        lines += [("", "    " + line), (style, "    " + carets)]
    if problem.hint:
        lines.append(("cyan", "  hint: " + escaped(problem.hint)))
    return lines


def _is_terminal() -> bool:
    return sys.stderr is not None and not sys.stderr.closed and sys.stderr.isatty()


def _is_coloured() -> bool:
    """Return whether messages have colour: NO_COLOR, then FORCE_COLOR say it."""
    if os.environ.get("NO_COLOR"):
        return False
    is_forced = os.environ.get("FORCE_COLOR", "0") not in ("", "0")
    return is_forced or (_is_terminal() and os.environ.get("TERM") != "dumb")


def _is_colourless() -> bool:
    return bool(os.environ.get("NO_COLOR")) or os.environ.get("TERM") == "dumb"


def _write(lines: Iterable[tuple[str, str]]) -> None:
    # an error in reporting an error would hide it
    if sys.stderr is None or sys.stderr.closed:
        return
    with suppress(OSError):
        if _is_coloured():
            _write_coloured(lines)
        else:
            sys.stderr.write("".join(line + "\n" for _, line in lines))
        sys.stderr.flush()


def _write_coloured(lines: Iterable[tuple[str, str]]) -> None:
    from rich.console import Console
    from rich.text import Text

    # also in a pipe, where FORCE_COLOR asks for it
    console = Console(stderr=True, highlight=False, force_terminal=True)
    for style, line in lines:
        console.print(Text(line, style=style), soft_wrap=True)
