"""Changed documents: whole files put into a document, and single values that `--set` overrides."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from somo_cli.document.parse import Document, parse
from somo_cli.problems import InvalidFile, Pointer, Problem, Span, did_you_mean, pointer_text

_STEP = re.compile(r"(?P<dot>\.?)(?P<name>[^.\[\]=\s'\"]+)|\[(?P<index>[0-9]{1,9})\]")
_NOT_SET = "'{}' does not say what to set"
_NO_VALUE = "there is no value after the '='"
_EXAMPLE = "write it like links[0].mass=0.1"


def embed_all(document: Document, parts: Mapping[Pointer, Document]) -> Document:
    """Replace the value at each pointer by the root of a part, with its spans and texts.

    No pointer may lie inside another. A key keeps its place. The last step may be a new key of an
    existing mapping; any other pointer to nothing raises KeyError.
    """
    keys = {pointer: document.span(pointer, key=True) for pointer in parts}
    return _replace(document, parts, keys)


def override(document: Document, assignment: str) -> Document:
    """Return the document with one value set by `PATH=VALUE`, such as `links[0].mass=0.1`.

    The value is YAML. The last name of the path may be a new key of an existing mapping. The spans
    of the value lie in the assignment, whose source is called `--set 'PATH'`. Raises InvalidFile.
    """
    path, equals, value = assignment.partition("=")
    source = f"--set '{path}'"
    texts = {**document.texts, source: assignment}
    if not equals:
        problem = Problem(Span(source, 1, 1, max(1, len(path))), _NOT_SET.format(path), _EXAMPLE)
        raise InvalidFile([problem], texts)
    try:
        steps = _steps(path, source)
        pointer = _existing(document, steps)
        part = _value(value, len(path) + 1, source)
    except InvalidFile as error:
        raise InvalidFile(error.problems, texts) from error
    part = Document(source, part.data, {source: assignment}, part.spans)
    return _replace(document, {pointer: part}, {pointer: steps[-1][1]})


def _steps(path: str, source: str) -> list[tuple[str | int, Span]]:
    """Return the names and indices of a path, each with its place in the assignment."""
    steps: list[tuple[str | int, Span]] = []
    end = 0
    while end < len(path) or not steps:
        match = _STEP.match(path, end)
        # a dot precedes every name but the first
        if not match or (match["name"] and bool(match["dot"]) != bool(steps)):
            raise _refusal(Span(source, 1, end + 1), f"'{path}' is not a path", _EXAMPLE)
        start, end = match.start("name" if match["name"] else 0), match.end()
        step = match["name"] or int(match["index"])
        steps.append((step, Span(source, 1, start + 1, end - start)))
    return steps


def _existing(document: Document, steps: Sequence[tuple[str | int, Span]]) -> Pointer:
    """Return the steps as a pointer into the document.

    The last step may be a new key of a mapping. Raises InvalidFile for any other step that leads
    nowhere.
    """
    pointer: Pointer = ()
    here = document.data
    for number, (step, span) in enumerate(steps, start=1):
        if isinstance(step, int):
            here = _item_at(here, step, span, pointer_text(pointer))
        else:
            may_be_new = number == len(steps)
            here = _value_at(here, step, span, pointer_text(pointer), may_be_new)
        pointer = (*pointer, step)
    return pointer


def _item_at(holder: object, index: int, span: Span, name: str) -> object:
    """Return an item of the list called `name`; raise InvalidFile if there is none."""
    if not isinstance(holder, list):
        hint = "name a key instead" if isinstance(holder, dict) else ""
        raise _refusal(span, f"{name} is not a list", hint)
    if index >= len(holder):
        hint = f"the last one is [{len(holder) - 1}]" if holder else "the list is empty"
        raise _refusal(span, f"{name} has no item [{index}]", hint)
    return holder[index]


def _value_at(holder: object, key: str, span: Span, name: str, may_be_new: bool) -> object:
    """Return the value at a key of the mapping called `name`, None for a new key.

    Raises InvalidFile if the holder is no mapping, or lacks a key that must be there.
    """
    if not isinstance(holder, dict):
        hint = "name an index, such as [0]" if isinstance(holder, list) else ""
        raise _refusal(span, f"{name} is not a mapping", hint)
    if key not in holder and not may_be_new:
        raise _refusal(span, f"{name} has no key '{key}'", _known_keys_hint(key, holder))
    return holder.get(key)


def _value(value: str, column: int, source: str) -> Document:
    span = Span(source, 1, column + 1, max(1, len(value)))
    if not value.strip():
        raise _refusal(span, _NO_VALUE, "null stands for nothing")
    if value.lstrip().startswith("#"):
        raise _refusal(span, _NO_VALUE, "quote a value that starts with '#'")
    # blanks in place of the path keep the positions of the assignment
    part = parse(" " * column + value, source)
    if not isinstance(part.data, dict | list):
        return part
    start = Span(source, 1, column + 1 + len(value) - len(value.lstrip()))
    return Document(source, part.data, part.texts, {**part.spans, (): (start, start)})


def _refusal(span: Span, message: str, hint: str) -> InvalidFile:
    return InvalidFile([Problem(span, message, hint)])


def _replace(
    document: Document, parts: Mapping[Pointer, Document], keys: Mapping[Pointer, Span]
) -> Document:
    data = document.data
    lengths = {len(pointer) for pointer in parts}
    spans = {
        pointer: pair
        for pointer, pair in document.spans.items()
        if not any(pointer[:length] in parts for length in lengths)
    }
    texts = dict(document.texts)
    copied: set[Pointer] = set()
    for pointer, part in parts.items():
        data = _with(data, pointer, part.data, (), copied)
        key, value = keys[pointer], part.span(())
        spans[pointer] = (key, value)
        spans.update((pointer + below, pair) for below, pair in part.spans.items() if below)
        texts.update(part.texts)
    return Document(document.source, data, texts, spans)


def _with(
    value: object, pointer: Pointer, new: object, done: Pointer, copied: set[Pointer]
) -> object:
    """Return a value with `new` at a pointer below it; `done` is the pointer to the value itself.

    Mappings and lists on the way are copied, those in `copied` have been already. Raises KeyError.
    """
    if not pointer:
        return new
    step, rest = pointer[0], pointer[1:]
    way = (*done, step)
    if isinstance(value, dict) and isinstance(step, str) and (step in value or not rest):
        if done not in copied:
            value = dict(value)
        copied.add(done)
        value[step] = _with(value.get(step), rest, new, way, copied)
        return value
    if isinstance(value, list) and isinstance(step, int) and 0 <= step < len(value):
        if done not in copied:
            value = list(value)
        copied.add(done)
        value[step] = _with(value[step], rest, new, way, copied)
        return value
    raise KeyError(way)


def _known_keys_hint(name: str, known: Mapping[str, object]) -> str:
    return did_you_mean(name, known) or f"known keys: {', '.join(known)}"
