"""YAML text to a Document: plain values plus the position of every key and value."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from yaml.composer import Composer
from yaml.error import Mark, MarkedYAMLError, YAMLError
from yaml.events import AliasEvent, CollectionStartEvent, StreamEndEvent
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.resolver import Resolver
from yaml.scanner import Scanner

from somo_cli.problems import LINE_BREAK, MAX_TEXT_BYTES, InvalidFile, Pointer, Problem, Span

MAX_DEPTH = 50
MAX_VALUES = 200_000
_MAX_CHARACTERS = 20  # kinds of control characters reported

_PLAIN = "plain"  # our tag for a scalar without quotes and without a tag
_UNTAGGED = ""
_MERGE = "<<"

_INTEGER = re.compile(r"[-+]?[0-9]+")
_BASED_INTEGER = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_LEADING_ZERO = re.compile(r"[-+]?0[0-9]")
_NOT_FINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_WORDS: Mapping[str, bool | None] = (
    dict.fromkeys(("", "~", "null", "Null", "NULL"))
    | dict.fromkeys(("true", "True", "TRUE"), True)
    | dict.fromkeys(("false", "False", "FALSE"), False)
)
_NUMBER_START = frozenset("0123456789+-.")

_FORBIDDEN = re.compile(
    "[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"  # as YAML 1.2, 5.1
)
_PROPERTIES = re.compile(r"(?:[&!][^\s,\[\]{}]*[ \t]+)+")
_JSON_STRING_OR_TAB = re.compile(r'"(?:[^"\\]|\\.)*"|\t')


@dataclass(frozen=True, slots=True)
class Document:
    """Plain values, the texts they were written in, and a (key, value) pair of spans for each."""

    source: str
    data: object
    texts: Mapping[str, str]
    spans: Mapping[Pointer, tuple[Span, Span]]

    def span(self, pointer: Pointer, key: bool = False) -> Span:
        """Say where the value at a pointer, or its key, is written.

        A pointer to nothing gives the key that holds its nearest known ancestor, or, when that
        ancestor came from another file, the start of it.
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
    """Read YAML 1.2 (core schema, one document, no tags, string keys) or JSON.

    Raises InvalidFile with every fault that can be found.
    """
    text = text.removeprefix("\ufeff")
    texts = {source: text}
    start = Span(source, 1, 1)
    if len(text) > MAX_TEXT_BYTES or len(text.encode("utf-8", "surrogatepass")) > MAX_TEXT_BYTES:
        message = f"the text is longer than {MAX_TEXT_BYTES} bytes"
        raise InvalidFile([Problem(start, message)], texts)
    forbidden = _control_characters(text, source)
    if forbidden:
        raise InvalidFile(forbidden, texts)

    reader = _NodeReader(text, source)
    composer = _Composer(_without_json_tabs(text))
    try:
        root, surplus = composer.compose_one()
    except MarkedYAMLError as error:
        raise InvalidFile([reader.syntax_problem(error)], texts) from error
    except (YAMLError, ValueError, OverflowError) as error:
        # PyYAML 6.0 lets chr() fail on escapes such as "\UFFFFFFFF".
        problem = Problem(reader.place(composer.get_mark()), "this is not a character")
        raise InvalidFile([problem], texts) from error
    if root is None:
        raise InvalidFile([Problem(start, "the file is empty")], texts)
    value = reader.value(root, (), start)
    if surplus is not None:
        message = "a second document starts here"
        hint = "keep one document in a file"
        reader.problems.append(Problem(reader.place(surplus, 3), message, hint))
    if reader.problems:
        raise InvalidFile(reader.problems, texts)
    return Document(source, value, texts, reader.spans)


class _Composer(Reader, Scanner, Parser, Composer, Resolver):
    """PyYAML up to its node graph, with limits and without its YAML 1.1 notions of numbers."""

    def __init__(self, text: str) -> None:
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        Composer.__init__(self)
        Resolver.__init__(self)
        self._depth = 0  # enclosing collections
        self._reached = 0  # the deepest so far, with aliases expanded
        self._count = 0  # values so far, with aliases expanded
        self._extent: dict[int, tuple[int, int]] = {}  # node id: values, height

    def compose_one(self) -> tuple[Node | None, Mark | None]:
        """Return the root, and where a second document starts."""
        self.get_event()  # type: ignore[no-untyped-call]
        if self.check_event(StreamEndEvent):
            return None, None
        root: Node | None = self.compose_document()
        if isinstance(root, ScalarNode) and root.tag == _PLAIN and root.value == "":
            root = None
        if self.check_event(StreamEndEvent):
            return root, None
        following: Any = self.peek_event()  # type: ignore[no-untyped-call]
        return root, following.start_mark

    def resolve(self, kind: type[Node], value: object, implicit: object) -> str:
        plain = kind is ScalarNode and isinstance(implicit, tuple) and implicit[0]
        return _PLAIN if plain else _UNTAGGED

    def compose_node(self, parent: Node | None, index: Any) -> Node | None:
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, AliasEvent):
            node: Node | None = super().compose_node(parent, index)
            if id(node) not in self._extent:
                self._refuse(event, f"alias '*{event.anchor}' contains itself")
            count, height = self._extent[id(node)]
            self._grow(event, count, height)
            self._reached = max(self._reached, self._depth + height)
            return node
        height = int(isinstance(event, CollectionStartEvent))
        self._grow(event, 1, height)
        before, outer = self._count - 1, self._reached
        self._depth += height
        self._reached = self._depth
        node = super().compose_node(parent, index)
        self._depth -= height
        self._extent[id(node)] = (self._count - before, self._reached - self._depth)
        self._reached = max(outer, self._reached)
        return node

    def _grow(self, event: Any, count: int, height: int) -> None:
        self._count += count
        if self._count > MAX_VALUES:
            self._refuse(event, f"more than {MAX_VALUES} values, with aliases expanded")
        if self._depth + height > MAX_DEPTH:
            self._refuse(event, f"nested more than {MAX_DEPTH} deep")

    def _refuse(self, event: Any, message: str) -> None:
        raise MarkedYAMLError(problem=message, problem_mark=event.start_mark)


class _NodeReader:
    """One pass over the node graph, collecting values, spans and faults."""

    def __init__(self, text: str, source: str) -> None:
        self.spans: dict[Pointer, tuple[Span, Span]] = {}
        self.problems: list[Problem] = []
        self._text = text
        self._source = source

    def place(self, mark: Mark, width: int = 1, skipped: int = 0) -> Span:
        # The one place where lines and columns start to count from 1.
        return Span(self._source, mark.line + 1, mark.column + 1 + skipped, max(1, width))

    def value(self, node: Node, pointer: Pointer, key: Span | None) -> object:
        """Return the plain value of a node; `key` is None for an item of a list."""
        written = self._written(node)
        # An empty value has no place of its own, its key has.
        here = key if key and node.start_mark.index == node.end_mark.index else written
        if not pointer and not isinstance(node, ScalarNode):
            here = key or written
        self.spans[pointer] = (key or here, here)
        if node.tag not in (_PLAIN, _UNTAGGED):
            tag = node.tag.replace("tag:yaml.org,2002:", "!!")
            self._add_problem(
                self.place(node.start_mark), f"tag '{tag}' is not allowed", "remove the tag"
            )
        if isinstance(node, MappingNode):
            return {
                name: self.value(child, (*pointer, name), span)
                for name, span, child in self._entries(node)
            }
        if isinstance(node, SequenceNode):
            return [self.value(n, (*pointer, i), None) for i, n in enumerate(node.value)]
        if node.tag == _PLAIN:
            return self._plain(node.value, here)
        return self._quoted(node.value, here)

    def _written(self, node: Node) -> Span:
        start, end = node.start_mark, node.end_mark
        skipped = 0
        if self._text[start.index : start.index + 1] in ("&", "!"):
            properties = _PROPERTIES.match(self._text, start.index, end.index)
            skipped = len(properties[0]) if properties else 0
        if not isinstance(node, ScalarNode) or node.style in ("|", ">"):
            return self.place(start, 1, skipped)
        if start.line == end.line:
            return self.place(start, end.column - start.column - skipped, skipped)
        line_break = LINE_BREAK.search(self._text, start.index)
        stop = line_break.start() if line_break else end.index
        first = self._text[start.index + skipped : stop].rstrip()
        return self.place(start, len(first), skipped)

    def _entries(self, node: MappingNode) -> list[tuple[str, Span, Node]]:
        entries: list[tuple[str, Span, Node]] = []
        first: dict[str, Span] = {}
        merged: list[MappingNode] = []
        for key, child in node.value:
            span = self._written(key)
            name = self._key(key, span)
            if name in first:
                message = f"duplicate key '{_short(name)}', first on line {first[name].line}"
                self._add_problem(span, message, "keep one of them")
            first.setdefault(name, span)
            if name == _MERGE and key.tag == _PLAIN:
                merged.extend(self._merged(child))
            else:
                entries.append((name, span, child))
        for mapping in merged:
            inherited = [entry for entry in self._entries(mapping) if entry[0] not in first]
            first.update((name, span) for name, span, _ in inherited)
            entries.extend(inherited)
        return entries

    def _merged(self, node: Node) -> Iterator[MappingNode]:
        for part in node.value if isinstance(node, SequenceNode) else [node]:
            if isinstance(part, MappingNode):
                yield part
            else:
                message = f"'{_MERGE}' takes a mapping or a list of mappings"
                self._add_problem(self._written(part), message, "name an anchor, as in '<<: *base'")

    def _key(self, node: Node, span: Span) -> str:
        if not isinstance(node, ScalarNode):
            kind = "mapping" if isinstance(node, MappingNode) else "list"
            self._add_problem(span, f"a key must be a string, found a {kind}", "check the brackets")
            return f"\0{span}"
        if node.tag not in (_PLAIN, _UNTAGGED):
            tag = node.tag.replace("tag:yaml.org,2002:", "!!")
            self._add_problem(span, f"tag '{tag}' is not allowed", "remove the tag")
        elif node.tag == _PLAIN:
            known = len(self.problems)
            value = self._plain(node.value, span)
            if not isinstance(value, str) and len(self.problems) == known:
                message = f"a key must be a string, found {_short(node.value) or 'nothing'}"
                hint = f"write '{_short(node.value)}', in quotes" if node.value else "name the key"
                self._add_problem(span, message, hint)
            return str(node.value)
        return self._quoted(node.value, span)

    def _plain(self, text: str, span: Span) -> object:
        if text in _WORDS:
            return _WORDS[text]
        if text[0] not in _NUMBER_START:
            return text
        value: int | float
        if _FLOAT.fullmatch(text):
            if _LEADING_ZERO.match(text):
                plain = re.sub(r"^([-+]?)0+(?=[0-9])", r"\1", text)
                message = f"a number with a leading zero is ambiguous: {_short(text)}"
                self._add_problem(span, message, f"write {_short(plain)} or '{_short(text)}'")
                return 0
            value = float(text)
            if math.isfinite(value) and _INTEGER.fullmatch(text):
                value = int(text)
        elif _BASED_INTEGER.fullmatch(text):
            value = int(text, 0)
            value = value if value.bit_length() < 1024 else math.inf
        elif _NOT_FINITE.fullmatch(text):
            value = math.nan
        else:
            return text
        if not math.isfinite(value):
            self._add_problem(
                span, f"not a finite number: {_short(text)}", "write an ordinary number"
            )
            return 0
        return value

    def _quoted(self, text: str, span: Span) -> str:
        # JSON writes a character outside the first plane as two escapes; PyYAML keeps both halves.
        text = text.encode("utf-16", "surrogatepass").decode("utf-16", "surrogatepass")
        found = _FORBIDDEN.search(text)
        if found:
            self._add_problem(span, f"control character {found[0]!r} in a string", "remove it")
        return text

    def _add_problem(self, span: Span, message: str, hint: str) -> None:
        self.problems.append(Problem(span, message, hint))

    def syntax_problem(self, error: MarkedYAMLError) -> Problem:
        """Say what PyYAML found wrong, in our words where it has words of its own."""
        mark = error.problem_mark or error.context_mark
        found = error.problem or error.context or "not YAML"
        start = self.place(error.context_mark) if error.context_mark else None
        if start and re.match(_AT_ITS_START, found):
            mark = error.context_mark
        span = self.place(mark) if mark else Span(self._source, 1, 1)
        for pattern, message, hint in _SYNTAX:
            match = re.match(pattern, found)
            if match:
                if start:
                    hint = hint.format(line=start.line, column=start.column)
                return Problem(span, match.expand(message), hint)
        hint = (
            f"{error.context} that starts on line {start.line}" if error.context and start else ""
        )
        return Problem(span, found, hint)


# What PyYAML notices only at the end of what began too early.
_AT_ITS_START = r"could not find expected ':'|found unexpected end of stream"

# What PyYAML says, as a pattern; what we say; and what would be right, which may tell the line and
# column where the thing began that does not go on as it should.
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


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:56] + " ..."


def _control_characters(text: str, source: str) -> list[Problem]:
    # One problem for each kind of character: a binary file has thousands of each.
    first: dict[str, int] = {}
    for match in _FORBIDDEN.finditer(text):
        first.setdefault(match[0], match.start())
        if len(first) == _MAX_CHARACTERS:
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
    # JSON allows tabs between values, PyYAML does not; a space keeps every position.
    if "\t" not in text or text.lstrip()[:1] not in ("{", "["):
        return text
    try:
        json.loads(text)
    except (ValueError, RecursionError):
        return text
    return _JSON_STRING_OR_TAB.sub(lambda m: " " if m[0] == "\t" else m[0], text)
