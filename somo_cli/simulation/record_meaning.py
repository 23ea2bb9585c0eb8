"""Faults of what a scene records: patterns that match nothing, names that would be ambiguous."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase

from somo_cli.document.parse import Document
from somo_cli.problems import Problem
from somo_cli.simulation import scene
from somo_cli.simulation.scene import Scene
from somo_cli.simulation.surface import GROUND


def faults(document: Document) -> Iterator[Problem]:
    """Yield the faults of the recording of a scene that has no others."""
    record = document.data.get("record") if isinstance(document.data, Mapping) else None
    if not isinstance(record, Mapping):
        return
    found = scene.read(document)
    yield from _ground_faults(document, found, bool(record.get("events", False)))
    for index, pattern in enumerate(record.get("only", ())):
        hint = hint_for(found, pattern)
        if hint is not None:
            place = document.span(("record", "only", index))
            yield Problem(place, f"no column matches '{pattern}'", hint)


def hint_for(found: Scene, pattern: str) -> str | None:
    """Return what to say of a pattern that matches no column of a scene; None if one does."""
    offered = _names(found)
    if any(fnmatchcase(name, pattern) for names in offered.values() for name in names):
        return None
    everything = _names(
        dataclasses.replace(found, columns=scene.ALL_COLUMNS, of_things=scene.ALL_READINGS)
    )
    for (key, kind), names in everything.items():
        if any(fnmatchcase(name, pattern) for name in names):
            return f"it is among {kind}, which record.{key} does not list"
    known = [name for names in everything.values() for name in names]
    close = get_close_matches(pattern, known, 1)
    return f"did you mean '{close[0]}'?" if close else f"columns are called like '{known[0]}'"


def _names(found: Scene) -> Mapping[tuple[str, str], Sequence[str]]:
    """Return the names of all columns by the key of record and the kind; `only` left aside."""
    # numpy is slow to load, and few scenes have patterns
    from somo_cli.simulation import columns
    from somo_cli.simulation.plan import make_plan

    plan = make_plan(dataclasses.replace(found, only=()))
    names: dict[tuple[str, str], list[str]] = {}
    for group in columns.groups(plan):
        names.setdefault(("columns", group.quantity), []).extend(group.kept.names)
    for of_object in columns.thing_groups(plan):
        names.setdefault(("objects", of_object.reading), []).extend(of_object.kept.names)
    return names


def has_two_grounds(found: Scene) -> bool:
    """Whether in columns and events of contacts the ground could be taken for something else."""
    names = [one.name for one in found.manipulators] + [one.name for one in found.things]
    return found.ground is not None and GROUND in names


def _ground_faults(document: Document, found: Scene, has_events: bool) -> Iterator[Problem]:
    """Refuse to tell the ground from something else that is called so."""
    tells = has_events or "contact_pairs" in (*found.columns, *found.of_things)
    if not tells or not has_two_grounds(found):
        return
    for index, manipulator in enumerate(found.manipulators):
        if manipulator.name == GROUND:
            yield Problem(
                document.span(("manipulators", index)),
                "a manipulator is called ground, as is the ground in columns of contacts",
                "give it another name",
            )
    for index, thing in enumerate(found.things):
        if thing.name == GROUND:
            yield Problem(
                document.span(("objects", index, "name")),
                "an object is called ground, as is the ground in columns of contacts",
                "give it another name",
            )
