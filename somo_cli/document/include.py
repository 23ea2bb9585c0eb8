"""Files named inside a document, read and put where they are named."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TypeAlias

from somo_cli.document.edit import embed_all
from somo_cli.document.parse import Document, parse
from somo_cli.document.yaml_nodes import MAX_VALUES
from somo_cli.problems import InvalidFile, Pointer, Problem, Span

OpenText: TypeAlias = Callable[[str, str], tuple[str, str]]
"""Opens `(naming source, path)` and returns `(source, text)`.

Raises OSError, InvalidFile, or ValueError for a path that is not allowed.
"""

MakeDocument: TypeAlias = Callable[[str, str, Span], Document]
"""Makes a document of `(text, source, span that names the file)`; raises as OpenText does."""

_PATH = "paths are relative to the file that names them, and stay in its folder or below"


def include(
    document: Document,
    places: Iterable[tuple[str, ...]],
    open_text: OpenText,
    make: MakeDocument | None = None,
) -> tuple[Document, tuple[Problem, ...]]:
    """Read the file named at each place; return the document with the files in it, and problems.

    A place is a pointer in which "*" stands for every item of a list. Outer places come first, so
    that an included file may name files in turn. The files are YAML and hold a mapping, or else
    `make` turns their text into documents. The problems are those of all files; a file that has
    one is left out.
    """
    reader = _FileReader(open_text, make)
    problems: list[Problem] = []
    texts = dict(document.texts)
    for place in places:
        parts: dict[Pointer, Document] = {}
        for pointer, path in _named(document.data, place):
            try:
                parts[pointer] = reader.read(path, document.span(pointer))
            except InvalidFile as error:
                problems.extend(error.problems)
                texts.update(error.texts)
        total = len(document.spans) + sum(len(part.spans) for part in parts.values())
        if total > MAX_VALUES:
            message = f"more than {MAX_VALUES} values, with the files it names"
            problems.append(Problem(document.span(()), message))
            break
        if parts:
            document = embed_all(document, parts)
        texts.update(document.texts)
    return replace(document, texts=texts), tuple(problems)


class _FileReader:
    """Reads files as documents; parses a file that is named again only once."""

    def __init__(self, open_text: OpenText, make: MakeDocument | None) -> None:
        self._open_text = open_text
        self._make = make
        self._parsed: dict[str, Document] = {}

    def read(self, path: str, span: Span) -> Document:
        """Return the file at a path that is named at a span; raise InvalidFile for its faults."""
        try:
            source, text = self._open_text(span.source, path)
            if self._make is not None:
                return self._make(text, source, span)
            return self._mapping_in(text, source)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            problem = Problem(span, f"cannot read '{path}': {reason}", _PATH)
            raise InvalidFile([problem]) from error
        except ValueError as error:
            problem = Problem(span, f"cannot use '{path}': {error}", _PATH)
            raise InvalidFile([problem]) from error

    def _mapping_in(self, text: str, source: str) -> Document:
        known = self._parsed.get(source)
        if known is None or known.texts[source] != text:
            known = self._parsed[source] = _require_mapping(parse(text, source))
        return known


def unresolved_references(
    document: Document, places: Iterable[tuple[str, ...]]
) -> Sequence[Pointer]:
    """Return the pointers to what still names a file."""
    return [pointer for place in places for pointer, _ in _named(document.data, place)]


def _require_mapping(part: Document) -> Document:
    """Return the document itself; raise InvalidFile if its root is not a mapping."""
    if isinstance(part.data, dict):
        return part
    found = "nothing" if part.data is None else f"only {part.data!r}"
    if isinstance(part.data, list):
        found = "a list"
    problem = Problem(part.span(()), f"expected a mapping, found {found}")
    raise InvalidFile([problem], part.texts)


def _named(
    data: object, place: tuple[str, ...], done: Pointer = ()
) -> Iterator[tuple[Pointer, str]]:
    """Yield the pointer to each path that stands at a place below `done`, and the path."""
    if not place:
        if isinstance(data, str) and data:
            yield done, data
        return
    step, rest = place[0], place[1:]
    if step == "*" and isinstance(data, list):
        for index, item in enumerate(data):
            yield from _named(item, rest, (*done, index))
    elif isinstance(data, dict) and step in data:
        yield from _named(data[step], rest, (*done, step))
