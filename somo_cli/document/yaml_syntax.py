"""Syntax errors of PyYAML to problems with positions of ours and plainer words."""

from __future__ import annotations

import re

from yaml.error import Mark, MarkedYAMLError

from somo_cli.problems import Problem, Span


def span_at(source: str, mark: Mark, width: int = 1, skipped: int = 0) -> Span:
    """Return the span at a mark of PyYAML, which counts from 0, or `skipped` characters after."""
    return Span(source, mark.line + 1, mark.column + 1 + skipped, max(1, width))


def syntax_problem(error: MarkedYAMLError, source: str) -> Problem:
    """Return the problem of a syntax error of PyYAML, in plainer words if it is a known one."""
    mark = error.problem_mark or error.context_mark
    found = error.problem or error.context or "not YAML"
    start = span_at(source, error.context_mark) if error.context_mark else None
    if start and re.match(_AT_ITS_START, found):
        mark = error.context_mark
    span = span_at(source, mark) if mark else Span(source, 1, 1)
    for pattern, message, hint in _SYNTAX:
        match = re.match(pattern, found)
        if match:
            if start:
                hint = hint.format(line=start.line, column=start.column)
            return Problem(span, match.expand(message), hint)
    hint = f"{error.context} that starts on line {start.line}" if error.context and start else ""
    return Problem(span, found, hint)


# PyYAML notices these errors only at the end of what they spoil: report the start.
_AT_ITS_START = r"could not find expected ':'|found unexpected end of stream"

# A pattern of PyYAML's message, our message, and a hint, which may name the line and column where
# the unfinished part began.
_SYNTAX = (
    (
        r"mapping values are not allowed",
        "a ':' cannot stand here",
        "put the value in quotes, or check the indentation",
    ),
    (r"found character '\\t'", "a tab cannot stand here", "use spaces"),
    (
        r"found character (\S+) that cannot start",
        r"a value cannot start with \1",
        "put the value in quotes",
    ),
    (
        r"expected <block end>, but found '<(?:block|scalar).*'",
        "the indentation does not fit the lines above",
        "lines that go with line {line} start in column {column}",
    ),
    (
        r"expected <block end>, but found '<?(.*?)>?'",
        r"unexpected '\1'",
        "check the indentation of this line and the line above",
    ),
    (r"could not find expected ':'", "a ':' is missing after the key", "write 'key: value'"),
    (
        r"expected (',' or '.'), but got .*",
        r"expected \1",
        "the bracket opened on line {line}, column {column}, is not closed, or a comma is missing",
    ),
    (r"found unexpected end of stream", "this quote is not closed", "close it, or remove it"),
    (r"found undefined alias '(.*)'", r"alias '*\1' has no anchor '&\1' above it", ""),
    (r"second occurrence", "this anchor is already in use", "give it another name"),
)
