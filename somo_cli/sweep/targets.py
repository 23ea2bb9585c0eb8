"""The paths of a parameter: which values of a scene, and of the files that it names, it sets.

A path is written as for `--set`. Beside that an item of a list can be named by its `name`, as in
`objects[ball].mass`, and `definition(finger.yaml).` begins a path inside a file, at every place at
which the scene, or a file that it names, uses that file.
"""

from __future__ import annotations

import re
from pathlib import PurePath

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, SomoError, did_you_mean

_IN_FILE = re.compile(r"definition\((?P<file>[^()]+)\)\.?(?P<rest>.*)", re.DOTALL)
_STEP = re.compile(r"\.?(?P<key>[^.\[\]=\s'\"]+)|\[(?P<item>[^\[\]]+)\]")


class TargetError(SomoError):
    """A path that leads nowhere, with a hint."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.hint = hint


def pointers_of(document: Document, path: str) -> tuple[Pointer, ...]:
    """Return where a path leads in a scene whose files are included; raise TargetError."""
    match = _IN_FILE.fullmatch(path)
    if match is None:
        return (_pointer(document, (), path),)
    places = _places_of(document, match["file"])
    if not places:
        known = sorted({PurePath(source).name for source in _sources(document)})
        hint = did_you_mean(match["file"], known) or f"files: {', '.join(known) or 'none'}"
        raise TargetError(f"the scene uses no file '{match['file']}'", hint)
    return tuple(_pointer(document, place, match["rest"]) for place in places)


def _sources(document: Document) -> set[str]:
    """Return the files that the scene, or a file of it, names."""
    return {
        value.source for key, value in document.spans.values() if value.source != key.source
    } - {document.source}


def _places_of(document: Document, file: str) -> list[Pointer]:
    """Return where a file was included; it is named by the end of its path."""
    wanted = PurePath(file).parts
    return [
        pointer
        for pointer, (key, value) in document.spans.items()
        if value.source != key.source and PurePath(value.source).parts[-len(wanted) :] == wanted
    ]


def _pointer(document: Document, start: Pointer, path: str) -> Pointer:
    pointer = start
    end = 0
    here = document.at(start)
    while end < len(path):
        match = _STEP.match(path, end)
        if match is None:
            raise TargetError(f"'{path}' is not a path", "write it like objects[ball].mass")
        end = match.end()
        step: str | int
        if match["item"] is not None:
            step = _item(here, match["item"], path)
            here = here[step] if isinstance(here, list) else None
        else:
            step = match["key"]
            # as for --set, the last name may be new
            here = _value_at(here, step, path, may_be_new=end == len(path))
        pointer = (*pointer, step)
    if pointer == start:
        raise TargetError(f"'{path}' names no value", "write it like objects[ball].mass")
    return pointer


def _value_at(holder: object, key: str, path: str, may_be_new: bool) -> object:
    known = holder if isinstance(holder, dict) else {}
    if key not in known and not (may_be_new and isinstance(holder, dict)):
        hint = did_you_mean(key, known) or f"known keys: {', '.join(known) or 'none'}"
        raise TargetError(f"'{path}' leads nowhere: there is no '{key}'", hint)
    return known.get(key)


def _item(holder: object, name: str, path: str) -> int:
    if not isinstance(holder, list):
        raise TargetError(f"'{path}' leads nowhere: [{name}] is not in a list", "")
    if name.isascii() and name.isdigit():
        if int(name) < len(holder):
            return int(name)
        hint = f"the last one is [{len(holder) - 1}]" if holder else "the list is empty"
        raise TargetError(f"'{path}' leads nowhere: there is no item [{name}]", hint)
    names = [one.get("name") if isinstance(one, dict) else None for one in holder]
    if name in names:
        return names.index(name)
    known = [one for one in names if isinstance(one, str)]
    hint = did_you_mean(name, known) or f"names: {', '.join(known) or 'none'}"
    raise TargetError(f"'{path}' leads nowhere: there is no item called '{name}'", hint)
