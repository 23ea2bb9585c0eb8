"""Numbers set in a text as it was written: comments, order and layout stay, byte for byte."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

from somo_cli.document.parse import Document, parse
from somo_cli.problems import LINE_BREAK, InvalidFile, Pointer, Problem

_Number: TypeAlias = float | tuple[float, ...]
_Numbers: TypeAlias = Mapping[Pointer, _Number]

_MARK = "\ufeff"
_COLON = re.compile(r"[ \t]*:")
_PLAIN_KEY = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_PLAIN_LIST = re.compile(r"\[[^\[\]{}\"'#]*\]")
_BRACES = re.compile(r"\{\s*\}")
_CLOSER = re.compile(r"(?:[\s,]|#[^\r\n]*[\r\n])*[\]}]")
_ROOT_BRACE = re.compile(r"(?:\s|[#%][^\r\n]*[\r\n]|---(?=\s))*\{")
_ITEM = re.compile(r"-(?:\s|$)")
_LINE_IS_OVER = re.compile(r"[ \t]*,?[ \t]*[\r\n]")

_OTHERWISE = "the text around it would read differently"
_BY_ALIAS = "by an alias or a merge key"
_BY_FILE = "as its file is included more than once"


class _Refusal(Exception):
    """Why one value cannot be set."""


@dataclass(frozen=True, slots=True)
class _Edit:
    start: int
    stop: int
    new: str
    adds: bool = False  # a key; it comes after a value that is set at the same place


@dataclass(frozen=True, slots=True)
class _File:
    """The text of one source, what it reads as by itself, and where its lines start and it ends."""

    text: str
    part: Document
    lines: Sequence[int]

    def start(self, pointer: Pointer, key: bool = False) -> int:
        span = self.part.span(pointer, key)
        return self.lines[span.line - 1] + span.column - 1

    def inside(self, pointer: Pointer) -> list[Pointer]:
        """Return the pointers to the value and to all in it."""
        return [each for each in self.part.spans if each[: len(pointer)] == pointer]


def patched(
    document: Document,
    source: str,
    values: Mapping[Pointer, float | Sequence[float]],
    after: Mapping[str, str] | None = None,
) -> str:
    """Return the text of one source of the document with the values at the pointers set.

    A key that is missing in a mapping is added, behind the sibling that `after` names for it, or
    else behind the last one. A list of as many numbers as are there is set item by item. A value
    that several pointers share is set only if all of them are given, with the same number.
    Raises InvalidFile with a problem for each value that cannot be set without touching
    something else, KeyError for a source that the document lacks, ValueError for a number that
    is not finite.
    """
    whole = document.texts[source]
    text = whole.removeprefix(_MARK)
    lines = (0, *(match.end() for match in LINE_BREAK.finditer(text)), len(text))
    file = _File(text, parse(text, source), lines)
    targets = {pointer: _targets(document, pointer, value) for pointer, value in values.items()}
    every = {target: number for each in targets.values() for target, number in each.items()}
    places: dict[Pointer, _Numbers] = {}
    edits: dict[Pointer, list[_Edit]] = {}
    refused: dict[Pointer, str] = {}
    for pointer, numbers in targets.items():
        try:
            here = {_place(document, file, p, every): number for p, number in numbers.items()}
            edits[pointer] = [_edit(file, p, number, after or {}) for p, number in here.items()]
            places[pointer] = here
        except _Refusal as refusal:
            refused[pointer] = str(refusal)
    if not refused and not _holds(file, edits.values(), places.values()):
        alone = [p for p in values if not _holds(file, [edits[p]], [places[p]])]
        refused = dict.fromkeys(alone or values, _OTHERWISE)
    if refused:
        problems = [_problem(document, p, values[p], reason) for p, reason in refused.items()]
        raise InvalidFile(problems, document.texts)
    return whole[: len(whole) - len(text)] + _applied(text, edits.values())


def _targets(
    document: Document, pointer: Pointer, value: float | Sequence[float]
) -> dict[Pointer, _Number]:
    # Item by item, what stands between the items stays.
    numbers = tuple(map(float, value)) if isinstance(value, Sequence) else (float(value),)
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"{_path(pointer)} cannot be {value}: not finite")
    if not isinstance(value, Sequence):
        return {pointer: numbers[0]}
    there = document.at(pointer) if pointer in document.spans else None
    if isinstance(there, list) and numbers and len(there) == len(numbers):
        return {(*pointer, index): number for index, number in enumerate(numbers)}
    return {pointer: numbers}


def _place(document: Document, file: _File, pointer: Pointer, every: _Numbers) -> Pointer:
    # The pointer from the root of the file, if nothing else would change with the value.
    known = pointer if pointer in document.spans else pointer[:-1]
    missing = pointer[len(known) :]
    if known not in document.spans or (missing and not isinstance(document.at(known), dict)):
        raise _Refusal(f"{_path(known)} is not a mapping that is there")
    source = document.spans[known][1].source
    if source != file.part.source:
        raise _Refusal(f"it stands in '{source}'")
    root = len(known)
    while root and document.spans[known[: root - 1]][1].source == source:
        root -= 1
    for part, start, way in ((file.part, root, _BY_ALIAS), (document, 0, _BY_FILE)):
        for other in _sharing(part, known[start:]):
            full = (*pointer[:start], *other, *missing)
            if every.get(full) != every[pointer]:
                raise _Refusal(f"it is shared with {_path(full)}, {way}")
    if file.part.spans.get(known[root:], ())[1:] != document.spans[known][1:]:
        raise _Refusal(_OTHERWISE)
    return pointer[root:]


def _sharing(document: Document, pointer: Pointer) -> list[Pointer]:
    # A collection may start where its first key does, and is no other value for that.
    pair = document.spans.get(pointer)
    others = [p for p, other in document.spans.items() if pair and other[1] == pair[1]]
    return [p for p in others if p[: len(pointer)] != pointer and pointer[: len(p)] != p]


def _edit(file: _File, place: Pointer, number: _Number, after: Mapping[str, str]) -> _Edit:
    if place not in file.part.spans:
        return _addition(file, place, number, after)
    there, start = file.part.at(place), file.start(place)
    if isinstance(there, dict):
        raise _Refusal("a mapping is written there")
    if isinstance(there, list):
        brackets = _PLAIN_LIST.match(file.text, start)
        if not brackets or not isinstance(number, tuple):
            raise _Refusal(f"a list of {len(there)} is written there")
        return _Edit(start, brackets.end(), _written(number))
    stop = _end(file, place)
    if _is_empty(file, place):
        if file.text[stop - 1] != ":":
            raise _Refusal("its key has no ':'")
        return _Edit(stop, stop, f" {_written(number)}")
    try:
        on_one_line = parse(file.text[start:stop], file.part.source).data == there
    except InvalidFile:
        on_one_line = False
    if not on_one_line:
        raise _Refusal("it is not written on one line")
    return _Edit(start, stop, _written(number))


def _is_empty(file: _File, place: Pointer) -> bool:
    key, span = file.part.spans[place]
    return place[-1:] != () and isinstance(place[-1], str) and key == span


def _end(file: _File, place: Pointer) -> int:
    # Where a scalar on one line ends, or the colon before one that is empty.
    stop = file.start(place) + file.part.span(place).width
    colon = _COLON.match(file.text, stop) if _is_empty(file, place) else None
    return colon.end() if colon else stop


def _addition(file: _File, place: Pointer, number: _Number, after: Mapping[str, str]) -> _Edit:
    holder, name = place[:-1], str(place[-1])
    mapping: Any = file.part.at(holder)
    opening = file.start(holder)
    keys = {key: file.start((*holder, key), key=True) for key in mapping}
    # What came by a merge key is written above.
    keys = {key: start for key, start in keys.items() if start >= opening}
    if not keys and not _BRACES.match(file.text, opening):
        raise _Refusal("no key of its mapping is written there")
    for heir in (heir for key in keys for heir in _heirs(file.part, holder, key)):
        if (*heir, name) not in file.part.spans:
            raise _Refusal(f"its mapping is merged into {_path(heir)}")
    last = max(keys, key=keys.__getitem__, default="")
    sibling = after[name] if after.get(name) in keys else last
    like = keys.get(sibling, file.start(holder, key=True))
    plain = _PLAIN_KEY.fullmatch(name) and file.text[like] not in "\"'"
    entry = f"{name if plain else json.dumps(name, ensure_ascii=False)}: {_written(number)}"
    if not keys:
        return _Edit(opening + 1, opening + 1, entry, adds=True)
    in_flow = file.text[opening] == "{" if holder else _ROOT_BRACE.match(file.text)
    return (_beside if in_flow else _below)(file, (*holder, sibling), entry)


def _heirs(part: Document, holder: Pointer, key: str) -> list[Pointer]:
    # The other mappings that have the key from this one, but are not the same by an alias.
    place = (*holder, key)
    found = [p[:-1] for p in _sharing(part, place) if part.spans[p] == part.spans[place]]
    return [heir for heir in found if part.spans[heir][1] != part.spans[holder][1]]


def _below(file: _File, sibling: Pointer, entry: str) -> _Edit:
    # A line of its own, under the last one that belongs to the sibling.
    key = file.part.span(sibling, key=True)
    indent = key.column - 1
    last = max(key.line, *(file.part.span(each).line for each in file.inside(sibling)))
    for number, (start, stop) in enumerate(pairwise(file.lines), start=1):
        line = file.text[start:stop]
        rest = line.lstrip(" ")
        if number <= last or not rest.strip():
            continue
        deeper = len(line) - len(rest) - indent
        # The items of a list may stand as far left as its key, a bracket anywhere.
        if rest[0] not in "]}" and deeper < (not _ITEM.match(rest)):
            break
        last = number
    line_break = _line_break(file, sibling)
    own_line = " " * indent + entry
    is_closed = last < len(file.lines) - 1
    new = own_line + line_break if is_closed else line_break + own_line
    return _Edit(file.lines[last], file.lines[last], new, adds=True)


def _line_break(file: _File, pointer: Pointer) -> str:
    found = LINE_BREAK.search(file.text, file.start(pointer, key=True))
    found = found or LINE_BREAK.search(file.text)
    return found[0] if found else "\n"


def _beside(file: _File, sibling: Pointer, entry: str) -> _Edit:
    # Behind the value of the sibling; on a line of its own if the sibling has one.
    key = file.start(sibling, key=True)
    last = max(file.inside(sibling), key=file.start)
    if file.start(last) < key:
        raise _Refusal("it would follow an alias")
    is_collection = isinstance(file.part.at(last), dict | list)
    stop = file.start(last) + 1 if is_collection else _end(file, last)
    for _ in range(len(last) - len(sibling) + is_collection):
        closer = _CLOSER.match(file.text, stop)
        if not closer:
            raise _Refusal("it would follow an alias")
        stop = closer.end()
    margin = file.text[file.lines[file.part.span(sibling, key=True).line - 1] : key]
    own_line = not margin.strip() and _LINE_IS_OVER.match(file.text, stop)
    between = _line_break(file, sibling) + margin if own_line else " "
    return _Edit(stop, stop, f",{between}{entry}", adds=True)


def _written(number: _Number) -> str:
    # As JSON, which our YAML reads as the same float.
    return json.dumps(number)


def _applied(text: str, edits: Iterable[list[_Edit]]) -> str:
    # A shared value is set once, however many pointers lead to it.
    unique = dict.fromkeys(edit for each in edits for edit in each)
    pieces, end = [], 0
    for edit in sorted(unique, key=lambda edit: (edit.start, edit.adds)):
        pieces += [text[end : edit.start], edit.new]
        end = edit.stop
    return "".join((*pieces, text[end:]))


def _holds(file: _File, edits: Iterable[list[_Edit]], places: Iterable[_Numbers]) -> bool:
    # Whether the new text reads as the old one but for the numbers.
    try:
        found = parse(_applied(file.text, edits), file.part.source).data
    except InvalidFile:
        return False
    wanted: Any = {"": deepcopy(file.part.data)}
    for numbers in places:
        for place, number in numbers.items():
            holder = wanted
            for step in ("", *place)[:-1]:
                holder = holder[step]
            holder[("", *place)[-1]] = number
    # In JSON 1, 1.0 and true are three things, which == does not tell apart.
    return json.dumps(found, sort_keys=True) == json.dumps(wanted[""], sort_keys=True)


def _problem(
    document: Document, pointer: Pointer, value: float | Sequence[float], reason: str
) -> Problem:
    number = tuple(map(float, value)) if isinstance(value, Sequence) else float(value)
    message = f"this value cannot be set by itself: {reason}"
    name = _path(pointer).strip("'").rpartition(".")[2]
    hint = f"set {name}: {_written(number)} by hand"
    return Problem(document.span(pointer), message, hint)


def _path(pointer: Pointer) -> str:
    steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in pointer)
    return "'" + "".join(steps).removeprefix(".") + "'" if pointer else "the file"
