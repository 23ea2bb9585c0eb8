"""PyYAML's nodes to plain values by the core schema of YAML 1.2, with the position of each."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping

from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from somo_cli.document.yaml_nodes import PLAIN, UNTAGGED
from somo_cli.document.yaml_syntax import span_at
from somo_cli.problems import LINE_BREAK, Pointer, Problem, Span, shortened

FORBIDDEN = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""A character that no YAML may hold (YAML 1.2, section 5.1)."""

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
_PROPERTIES = re.compile(r"(?:[&!][^\s,\[\]{}]*[ \t]+)+")


class NodeReader:
    """Reads a node graph in one pass; collects the spans of all values, and all problems."""

    def __init__(self, text: str, source: str) -> None:
        self.spans: dict[Pointer, tuple[Span, Span]] = {}
        self.problems: list[Problem] = []
        self._text = text
        self._source = source

    def value(self, node: Node, pointer: Pointer, key: Span | None) -> object:
        """Return the plain value of a node; `key` is None for an item of a list."""
        written = self._written(node)
        # an empty value has no position: take that of its key
        here = key if key and node.start_mark.index == node.end_mark.index else written
        if not pointer and not isinstance(node, ScalarNode):
            here = key or written
        self.spans[pointer] = (key or here, here)
        if node.tag not in (PLAIN, UNTAGGED):
            tag = node.tag.replace("tag:yaml.org,2002:", "!!")
            self._add_problem(
                span_at(self._source, node.start_mark),
                f"tag '{tag}' is not allowed",
                "remove the tag",
            )
        if isinstance(node, MappingNode):
            return {
                name: self.value(child, (*pointer, name), span)
                for name, span, child in self._entries(node)
            }
        if isinstance(node, SequenceNode):
            return [self.value(n, (*pointer, i), None) for i, n in enumerate(node.value)]
        if node.tag == PLAIN:
            return self._plain(node.value, here)
        return self._quoted(node.value, here)

    def _written(self, node: Node) -> Span:
        start, end = node.start_mark, node.end_mark
        skipped = 0
        if self._text[start.index : start.index + 1] in ("&", "!"):
            properties = _PROPERTIES.match(self._text, start.index, end.index)
            skipped = len(properties[0]) if properties else 0
        if not isinstance(node, ScalarNode) or node.style in ("|", ">"):
            return span_at(self._source, start, 1, skipped)
        if start.line == end.line:
            return span_at(self._source, start, end.column - start.column - skipped, skipped)
        line_break = LINE_BREAK.search(self._text, start.index)
        stop = line_break.start() if line_break else end.index
        first = self._text[start.index + skipped : stop].rstrip()
        return span_at(self._source, start, len(first), skipped)

    def _entries(self, node: MappingNode) -> list[tuple[str, Span, Node]]:
        entries: list[tuple[str, Span, Node]] = []
        first: dict[str, Span] = {}
        merged: list[MappingNode] = []
        for key, child in node.value:
            span = self._written(key)
            name = self._key(key, span)
            if name in first:
                message = f"duplicate key '{shortened(name)}', first on line {first[name].line}"
                self._add_problem(span, message, "keep one of them")
            first.setdefault(name, span)
            if name == _MERGE and key.tag == PLAIN:
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
        if node.tag not in (PLAIN, UNTAGGED):
            tag = node.tag.replace("tag:yaml.org,2002:", "!!")
            self._add_problem(span, f"tag '{tag}' is not allowed", "remove the tag")
        elif node.tag == PLAIN:
            known = len(self.problems)
            value = self._plain(node.value, span)
            if not isinstance(value, str) and len(self.problems) == known:
                message = f"a key must be a string, found {shortened(node.value) or 'nothing'}"
                hint = (
                    f"write '{shortened(node.value)}', in quotes" if node.value else "name the key"
                )
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
                message = f"a number with a leading zero is ambiguous: {shortened(text)}"
                self._add_problem(span, message, f"write {shortened(plain)} or '{shortened(text)}'")
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
                span, f"not a finite number: {shortened(text)}", "write an ordinary number"
            )
            return 0
        return value

    def _quoted(self, text: str, span: Span) -> str:
        # JSON escapes a character outside the first plane in two halves, which PyYAML leaves apart
        text = text.encode("utf-16", "surrogatepass").decode("utf-16", "surrogatepass")
        found = FORBIDDEN.search(text)
        if found:
            self._add_problem(span, f"control character {found[0]!r} in a string", "remove it")
        return text

    def _add_problem(self, span: Span, message: str, hint: str) -> None:
        self.problems.append(Problem(span, message, hint))
