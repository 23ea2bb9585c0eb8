"""Edits of a text that set one number: in place of a value, or as a new key of a mapping."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

from somo_cli.document.parse import Document, parse
from somo_cli.problems import LINE_BREAK, InvalidFile, Pointer, pointer_text

Number: TypeAlias = float | tuple[float, ...]

_COLON = re.compile(r"[ \t]*:")
_PLAIN_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_PLAIN_LIST = re.compile(r"\[[^\[\]{}\"'#]*\]")
_BRACES = re.compile(r"\{\s*\}")
_CLOSER = re.compile(r"(?:[\s,]|#[^\r\n]*[\r\n])*[\]}]")
_ROOT_BRACE = re.compile(r"(?:\s|[#%][^\r\n]*[\r\n]|---(?=\s))*\{")
_ITEM = re.compile(r"-(?:\s|$)")
_LINE_IS_OVER = re.compile(r"[ \t]*,?[ \t]*[\r\n]")


class EditRefused(Exception):
    """One value cannot be set; the message says why."""


@dataclass(frozen=True, slots=True)
class Edit:
    """The characters from `start` to `stop` of a text, replaced by `new`."""

    start: int
    stop: int
    new: str
    adds: bool = False
    """Whether it adds a key; it then follows an edit of a value at the same place."""


@dataclass(frozen=True, slots=True)
class SourceText:
    """A text, the document in it, and the indices where its lines start, then where it ends."""

    text: str
    part: Document
    lines: Sequence[int]

    def start(self, pointer: Pointer, key: bool = False) -> int:
        """Return the index in the text at which a value, or its key, starts."""
        span = self.part.span(pointer, key)
        return self.lines[span.line - 1] + span.column - 1

    def inside(self, pointer: Pointer) -> list[Pointer]:
        """Return the pointers to a value and to all values in it."""
        return [each for each in self.part.spans if each[: len(pointer)] == pointer]


def edit_of(file: SourceText, place: Pointer, number: Number, after: Mapping[str, str]) -> Edit:
    """Return how the text changes so that the value at a place of the file is the number.

    `after` says behind which sibling a new key goes. Raises EditRefused.
    """
    if place not in file.part.spans:
        return _addition(file, place, number, after)
    there, start = file.part.at(place), file.start(place)
    if isinstance(there, dict):
        raise EditRefused("a mapping is written there")
    if isinstance(there, list):
        brackets = _PLAIN_LIST.match(file.text, start)
        if not brackets or not isinstance(number, tuple):
            raise EditRefused(f"a list of {len(there)} is written there")
        return Edit(start, brackets.end(), json_number(number))
    stop = _end(file, place)
    if _is_empty(file, place):
        if file.text[stop - 1] != ":":
            raise EditRefused("its key has no ':'")
        return Edit(stop, stop, f" {json_number(number)}")
    try:
        on_one_line = parse(file.text[start:stop], file.part.source).data == there
    except InvalidFile:
        on_one_line = False
    if not on_one_line:
        raise EditRefused("it is not written on one line")
    return Edit(start, stop, json_number(number))


def _is_empty(file: SourceText, place: Pointer) -> bool:
    key, span = file.part.spans[place]
    return place[-1:] != () and isinstance(place[-1], str) and key == span


def _end(file: SourceText, place: Pointer) -> int:
    """Return the index where a one-line scalar ends; if it is empty, where its colon does."""
    stop = file.start(place) + file.part.span(place).width
    colon = _COLON.match(file.text, stop) if _is_empty(file, place) else None
    return colon.end() if colon else stop


def _addition(file: SourceText, place: Pointer, number: Number, after: Mapping[str, str]) -> Edit:
    holder, name = place[:-1], str(place[-1])
    mapping: Any = file.part.at(holder)
    opening = file.start(holder)
    keys = {key: file.start((*holder, key), key=True) for key in mapping}
    # keys from a merge key are written above
    keys = {key: start for key, start in keys.items() if start >= opening}
    if not keys and not _BRACES.match(file.text, opening):
        raise EditRefused("no key of its mapping is written there")
    for heir in (heir for key in keys for heir in _merging_mappings(file.part, holder, key)):
        if (*heir, name) not in file.part.spans:
            raise EditRefused(f"its mapping is merged into {pointer_text(heir)}")
    last = max(keys, key=keys.__getitem__, default="")
    sibling = after[name] if after.get(name) in keys else last
    like = keys.get(sibling, file.start(holder, key=True))
    plain = _PLAIN_KEY.fullmatch(name) and file.text[like] not in "\"'"
    entry = f"{name if plain else json.dumps(name, ensure_ascii=False)}: {json_number(number)}"
    if not keys:
        return Edit(opening + 1, opening + 1, entry, adds=True)
    in_flow = file.text[opening] == "{" if holder else _ROOT_BRACE.match(file.text)
    return (_after_in_flow if in_flow else _after_in_block)(file, (*holder, sibling), entry)


def _merging_mappings(part: Document, holder: Pointer, key: str) -> list[Pointer]:
    """Return the other mappings that have a key of the holder by a merge key, not by an alias."""
    place = (*holder, key)
    found = [p[:-1] for p in aliases_of(part, place) if part.spans[p] == part.spans[place]]
    return [heir for heir in found if part.spans[heir][1] != part.spans[holder][1]]


def _after_in_block(file: SourceText, sibling: Pointer, entry: str) -> Edit:
    """Return the edit that adds a line under the last one of the sibling."""
    key = file.part.span(sibling, key=True)
    indent = key.column - 1
    last = max(key.line, *(file.part.span(each).line for each in file.inside(sibling)))
    for number, (start, stop) in enumerate(pairwise(file.lines), start=1):
        line = file.text[start:stop]
        rest = line.lstrip(" ")
        if number <= last or not rest.strip():
            continue
        deeper = len(line) - len(rest) - indent
        # list items may be indented like their key, closing brackets in any way
        if rest[0] not in "]}" and deeper < (not _ITEM.match(rest)):
            break
        last = number
    line_break = _line_break(file, sibling)
    own_line = " " * indent + entry
    is_closed = last < len(file.lines) - 1
    new = own_line + line_break if is_closed else line_break + own_line
    return Edit(file.lines[last], file.lines[last], new, adds=True)


def _line_break(file: SourceText, pointer: Pointer) -> str:
    found = LINE_BREAK.search(file.text, file.start(pointer, key=True))
    found = found or LINE_BREAK.search(file.text)
    return found[0] if found else "\n"


def _after_in_flow(file: SourceText, sibling: Pointer, entry: str) -> Edit:
    """Return the edit that adds an entry behind the sibling, on its own line if that has one."""
    key = file.start(sibling, key=True)
    last = max(file.inside(sibling), key=file.start)
    if file.start(last) < key:
        raise EditRefused("it would follow an alias")
    is_collection = isinstance(file.part.at(last), dict | list)
    stop = file.start(last) + 1 if is_collection else _end(file, last)
    for _ in range(len(last) - len(sibling) + is_collection):
        closer = _CLOSER.match(file.text, stop)
        if not closer:
            raise EditRefused("it would follow an alias")
        stop = closer.end()
    margin = file.text[file.lines[file.part.span(sibling, key=True).line - 1] : key]
    own_line = not margin.strip() and _LINE_IS_OVER.match(file.text, stop)
    between = _line_break(file, sibling) + margin if own_line else " "
    return Edit(stop, stop, f",{between}{entry}", adds=True)


def aliases_of(document: Document, pointer: Pointer) -> list[Pointer]:
    """Return the pointers to the other values with the position of this one."""
    # a mapping may have the position of its first key: that is not an alias
    pair = document.spans.get(pointer)
    others = [p for p, other in document.spans.items() if pair and other[1] == pair[1]]
    return [p for p in others if p[: len(pointer)] != pointer and pointer[: len(p)] != p]


def json_number(number: Number) -> str:
    """Return a number as JSON, from which YAML 1.2 reads the same float."""
    return json.dumps(number)
