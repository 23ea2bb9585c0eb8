"""Sets numbers in a text and leaves every other byte as it is: comments, order, layout."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any, TypeAlias

from somo_cli.document.parse import Document, parse
from somo_cli.document.text_edit import (
    Edit,
    EditRefused,
    Number,
    SourceText,
    aliases_of,
    edit_of,
    json_number,
)
from somo_cli.problems import LINE_BREAK, InvalidFile, Pointer, Problem, pointer_text

_Numbers: TypeAlias = Mapping[Pointer, Number]

_BYTE_ORDER_MARK = "\ufeff"
_OTHERWISE = "the text around it would read differently"
_BY_ALIAS = "by an alias or a merge key"
_BY_FILE = "as its file is included more than once"


@dataclass(frozen=True, slots=True)
class _Change:
    """The edits that set numbers at places in a file."""

    numbers: _Numbers
    edits: Sequence[Edit]


def patched(
    document: Document,
    source: str,
    values: Mapping[Pointer, float | Sequence[float]],
    after: Mapping[str, str] | None = None,
) -> str:
    """Return the text of one source of the document with the values at the pointers set.

    A key that a mapping lacks is added: behind the sibling that `after` names for it, or else
    behind the last key. A list that keeps its length is set item by item. A value that several
    pointers share is set only if all of them are given, with the same number.

    Raises InvalidFile with a problem for each value that cannot be set without a change of
    something else. Raises KeyError for a source that the document lacks, and ValueError for a
    number that is not finite.
    """
    whole = document.texts[source]
    text = whole.removeprefix(_BYTE_ORDER_MARK)
    file = _parsed(text, source)
    targets = {pointer: _targets(document, pointer, value) for pointer, value in values.items()}
    changes, refused = _changes(document, file, targets, after or {})
    if refused:
        problems = [_problem(document, p, values[p], reason) for p, reason in refused.items()]
        raise InvalidFile(problems, document.texts)
    return whole[: len(whole) - len(text)] + _applied(text, changes)


def _parsed(text: str, source: str) -> SourceText:
    lines = (0, *(match.end() for match in LINE_BREAK.finditer(text)), len(text))
    return SourceText(text, parse(text, source), lines)


def _changes(
    document: Document,
    file: SourceText,
    targets: Mapping[Pointer, _Numbers],
    after: Mapping[str, str],
) -> tuple[list[_Change], dict[Pointer, str]]:
    """Return a change of the file for each pointer, and why there is none for the others.

    The changes are tried together. If the text then reads otherwise than wanted, those are
    refused that fail alone, or all of them if each works alone.
    """
    every = {target: number for each in targets.values() for target, number in each.items()}
    changes: dict[Pointer, _Change] = {}
    refused: dict[Pointer, str] = {}
    for pointer, numbers in targets.items():
        try:
            places = {_place(document, file, p, every): number for p, number in numbers.items()}
            edits = [edit_of(file, p, number, after) for p, number in places.items()]
            changes[pointer] = _Change(places, edits)
        except EditRefused as refusal:
            refused[pointer] = str(refusal)
    if not refused and not _reads_as_wanted(file, changes.values()):
        alone = [p for p, change in changes.items() if not _reads_as_wanted(file, [change])]
        refused = dict.fromkeys(alone or changes, _OTHERWISE)
    return list(changes.values()), refused


def _targets(
    document: Document, pointer: Pointer, value: float | Sequence[float]
) -> dict[Pointer, Number]:
    """Return the pointers to set, with their numbers; those of the items if a list is set.

    What stands between the items then stays. A list of another length is set as a whole. Raises
    ValueError for a number that is not finite.
    """
    numbers = tuple(map(float, value)) if isinstance(value, Sequence) else (float(value),)
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"{pointer_text(pointer)} cannot be {value}: not finite")
    if not isinstance(value, Sequence):
        return {pointer: numbers[0]}
    there = document.at(pointer) if pointer in document.spans else None
    if isinstance(there, list) and numbers and len(there) == len(numbers):
        return {(*pointer, index): number for index, number in enumerate(numbers)}
    return {pointer: numbers}


def _place(document: Document, file: SourceText, pointer: Pointer, every: _Numbers) -> Pointer:
    """Return a pointer of the document as one from the root of the file.

    Raises EditRefused if something else would change with the value. `every` holds all numbers
    to set, by their pointers in the document.
    """
    known = pointer if pointer in document.spans else pointer[:-1]
    missing = pointer[len(known) :]
    if known not in document.spans or (missing and not isinstance(document.at(known), dict)):
        raise EditRefused(f"{pointer_text(known)} is not a mapping that is there")
    source = document.spans[known][1].source
    if source != file.part.source:
        raise EditRefused(f"it stands in '{source}'")
    root = len(known)
    while root and document.spans[known[: root - 1]][1].source == source:
        root -= 1
    for part, start, way in ((file.part, root, _BY_ALIAS), (document, 0, _BY_FILE)):
        for other in aliases_of(part, known[start:]):
            full = (*pointer[:start], *other, *missing)
            if every.get(full) != every[pointer]:
                raise EditRefused(f"it is shared with {pointer_text(full)}, {way}")
    if file.part.spans.get(known[root:], ())[1:] != document.spans[known][1:]:
        raise EditRefused(_OTHERWISE)
    return pointer[root:]


def _applied(text: str, changes: Iterable[_Change]) -> str:
    """Return the text after the edits; an edit that several changes share is made once."""
    unique = dict.fromkeys(edit for change in changes for edit in change.edits)
    pieces, end = [], 0
    for edit in sorted(unique, key=lambda edit: (edit.start, edit.adds)):
        pieces += [text[end : edit.start], edit.new]
        end = edit.stop
    return "".join((*pieces, text[end:]))


def _reads_as_wanted(file: SourceText, changes: Collection[_Change]) -> bool:
    """Return whether the changed text reads as the old one, but for the numbers."""
    try:
        found = parse(_applied(file.text, changes), file.part.source).data
    except InvalidFile:
        return False
    wanted: Any = {"": deepcopy(file.part.data)}
    for change in changes:
        for place, number in change.numbers.items():
            holder = wanted
            for step in ("", *place)[:-1]:
                holder = holder[step]
            holder[("", *place)[-1]] = number
    # 1 == 1.0 == True in Python, but not in JSON
    return json.dumps(found, sort_keys=True) == json.dumps(wanted[""], sort_keys=True)


def _problem(
    document: Document, pointer: Pointer, value: float | Sequence[float], reason: str
) -> Problem:
    number = tuple(map(float, value)) if isinstance(value, Sequence) else float(value)
    message = f"this value cannot be set by itself: {reason}"
    name = pointer_text(pointer).strip("'").rpartition(".")[2]
    hint = f"set {name}: {json_number(number)} by hand"
    return Problem(document.span(pointer), message, hint)
