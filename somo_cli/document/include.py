"""Files named inside a document, read and put where they are named."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from somo_cli.document.edit import embed_all
from somo_cli.document.parse import MAX_VALUES, Document, parse
from somo_cli.problems import InvalidFile, Pointer, Problem, Span

_PATH = "paths are relative to the file that names them, and stay in its folder or below"


def include(
    document: Document,
    places: Iterable[tuple[str, ...]],
    open_text: Callable[[str, str], tuple[str, str]],
    make: Callable[[str, str, Span], Document] | None = None,
) -> tuple[Document, tuple[Problem, ...]]:
    """Read the file named at each place, and put the mapping in it there.

    A place is a pointer in which "*" stands for every item; outer places come first, so that
    an included file may name files in turn. `open_text(naming_source, path)` gives
    `(source, text)`, or raises OSError, InvalidFile, or ValueError for a path that is not
    allowed. Returns every fault of every file as well; what is at fault is not put in.
    Files of another kind than YAML are made documents by `make(text, source, naming_span)`.
    """
    problems: list[Problem] = []
    texts = dict(document.texts)
    read: dict[str, Document] = {}
    for place in places:
        parts: dict[Pointer, Document] = {}
        for pointer, path in _named(document.data, place):
            span = document.span(pointer)
            try:
                source, text = open_text(span.source, path)
                if make is not None:
                    parts[pointer] = make(text, source, span)
                    continue
                if source not in read or read[source].texts[source] != text:
                    read[source] = _mapping(parse(text, source))
            except InvalidFile as error:
                problems.extend(error.problems)
                texts.update(error.texts)
            except OSError as error:
                reason = (error.strerror or str(error)).lower()
                problems.append(Problem(span, f"cannot read '{path}': {reason}", _PATH))
            except ValueError as error:
                problems.append(Problem(span, f"cannot use '{path}': {error}", _PATH))
            else:
                parts[pointer] = read[source]
        total = len(document.spans) + sum(len(part.spans) for part in parts.values())
        if total > MAX_VALUES:
            message = f"more than {MAX_VALUES} values, with the files it names"
            problems.append(Problem(document.span(()), message))
            break
        document = embed_all(document, parts)
        texts.update(document.texts)
    return replace(document, texts=texts), tuple(problems)


def unresolved_references(
    document: Document, places: Iterable[tuple[str, ...]]
) -> Sequence[Pointer]:
    """Return the pointers to what still names a file."""
    return [pointer for place in places for pointer, _ in _named(document.data, place)]


def _mapping(part: Document) -> Document:
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
