"""YAML or JSON text to a Document: plain values and the position of every key and value."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass

from yaml.error import MarkedYAMLError, YAMLError

from somo_cli.document.yaml_nodes import NodeComposer
from somo_cli.document.yaml_syntax import span_at, syntax_problem
from somo_cli.document.yaml_values import FORBIDDEN, NodeReader
from somo_cli.problems import LINE_BREAK, MAX_TEXT_BYTES, InvalidFile, Pointer, Problem, Span

_MAX_REPORTED_CHARACTERS = 20  # kinds of control characters in one file
_JSON_STRING_OR_TAB = re.compile(r'"(?:[^"\\]|\\.)*"|\t')


@dataclass(frozen=True, slots=True)
class Document:
    """The values of a file and the position of each.

    `data` has plain values only. `spans` has, by pointer, the position of the key of a value and
    that of the value; `texts` has the texts of all sources that the positions lie in.
    """

    source: str
    data: object
    texts: Mapping[str, str]
    spans: Mapping[Pointer, tuple[Span, Span]]

    def span(self, pointer: Pointer, key: bool = False) -> Span:
        """Return the position of the value at a pointer, or of its key.

        For a value that is not there it is the position of the nearest mapping or list around it:
        of its key, or of its start if it stands in a file of its own.
        """
        if pointer in self.spans:
            return self.spans[pointer][0 if key else 1]
        for length in range(len(pointer) - 1, -1, -1):
            pair = self.spans.get(pointer[:length])
            if pair is not None:
                return pair[0] if pair[0].source == pair[1].source else pair[1]
        return Span(self.source, 1, 1)

    def at(self, pointer: Pointer) -> object:
        """Return the value at a pointer; raise KeyError if there is none."""
        value = self.data
        for step in pointer:
            if isinstance(value, list) and isinstance(step, int) and step in range(len(value)):
                value = value[step]
            elif isinstance(value, dict) and step in value:
                value = value.get(step)
            else:
                raise KeyError(pointer)
        return value


def parse(text: str, source: str) -> Document:
    """Return the document in a YAML or JSON text.

    YAML is that of version 1.2, core schema, without tags, with keys that are strings, and one
    document in a file. Raises InvalidFile with every error that can be found.
    """
    text = text.removeprefix("\ufeff")
    texts = {source: text}
    start = Span(source, 1, 1)
    if len(text) > MAX_TEXT_BYTES or len(text.encode("utf-8", "surrogatepass")) > MAX_TEXT_BYTES:
        message = f"the text is longer than {MAX_TEXT_BYTES} bytes"
        raise InvalidFile([Problem(start, message)], texts)
    forbidden = _control_character_problems(text, source)
    if forbidden:
        raise InvalidFile(forbidden, texts)

    reader = NodeReader(text, source)
    composer = NodeComposer(_without_json_tabs(text))
    try:
        root, surplus = composer.compose_one()
    except MarkedYAMLError as error:
        raise InvalidFile([syntax_problem(error, source)], texts) from error
    except (YAMLError, ValueError, OverflowError) as error:
        # PyYAML 6.0 lets chr() fail on escapes such as "\UFFFFFFFF".
        problem = Problem(span_at(source, composer.get_mark()), "this is not a character")
        raise InvalidFile([problem], texts) from error
    if root is None:
        raise InvalidFile([Problem(start, "the file is empty")], texts)
    value = reader.value(root, (), start)
    if surplus is not None:
        message = "a second document starts here"
        hint = "keep one document in a file"
        reader.problems.append(Problem(span_at(source, surplus, 3), message, hint))
    if reader.problems:
        raise InvalidFile(reader.problems, texts)
    return Document(source, value, texts, reader.spans)


def _control_character_problems(text: str, source: str) -> list[Problem]:
    """Return one problem for each control character that occurs, however often it does."""
    first: dict[str, int] = {}
    for match in FORBIDDEN.finditer(text):
        first.setdefault(match[0], match.start())
        if len(first) == _MAX_REPORTED_CHARACTERS:
            break
    problems = []
    for character, index in first.items():
        breaks = list(LINE_BREAK.finditer(text, 0, index))
        column = index - (breaks[-1].end() if breaks else 0) + 1
        span = Span(source, len(breaks) + 1, column)
        message = f"control character {character!r}"
        problems.append(Problem(span, message, "remove it, or write it as an escape in quotes"))
    return problems


def _without_json_tabs(text: str) -> str:
    """Return JSON with a space for each tab between values, which PyYAML does not allow."""
    if "\t" not in text or text.lstrip()[:1] not in ("{", "["):
        return text
    try:
        json.loads(text)
    except (ValueError, RecursionError):
        return text
    return _JSON_STRING_OR_TAB.sub(lambda m: " " if m[0] == "\t" else m[0], text)
