"""Faults of what a scene records: patterns that match nothing, names that would be ambiguous."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase

from somo_cli.document.parse import Document
from somo_cli.problems import Problem, did_you_mean
from somo_cli.scene import columns
from somo_cli.scene import model as scene_model
from somo_cli.scene.contact_surface import GROUND_NAME
from somo_cli.scene.model import Scene

AMBIGUOUS_GROUND = (
    "the scene calls something ground, as the ground is called in contacts: rename it"
)


def recording_problems(document: Document) -> Iterator[Problem]:
    """Yield the faults of the recording of a scene that has no others."""
    record = document.data.get("record") if isinstance(document.data, Mapping) else None
    if not isinstance(record, Mapping):
        return
    found = scene_model.read_scene(document)
    yield from _ground_problems(document, found, bool(record.get("events", False)))
    for index, pattern in enumerate(record.get("only", ())):
        hint = unmatched_pattern_hint(found, pattern)
        if hint is not None:
            place = document.span(("record", "only", index))
            yield Problem(place, f"no column matches '{pattern}'", hint)


def select_by_patterns(scene: Scene, patterns: Sequence[str]) -> Scene:
    """Return the scene recording, of all columns that there are, those that match a pattern.

    Raises ValueError for a pattern that matches none, and where a name would be ambiguous.
    """
    if is_ground_name_ambiguous(scene):
        raise ValueError(AMBIGUOUS_GROUND)
    whole = dataclasses.replace(
        scene,
        columns=scene_model.ALL_QUANTITIES,
        object_quantities=scene_model.ALL_OBJECT_QUANTITIES,
    )
    for pattern in patterns:
        hint = unmatched_pattern_hint(whole, pattern)
        if hint is not None:
            raise ValueError(f"no column matches {pattern!r}; {hint}")
    return dataclasses.replace(whole, only=tuple(patterns))


def unmatched_pattern_hint(found: Scene, pattern: str) -> str | None:
    """Return what to say of a pattern that matches no column of a scene; None if one does."""
    offered = _column_names_by_kind(found)
    if any(fnmatchcase(name, pattern) for names in offered.values() for name in names):
        return None
    everything = _column_names_by_kind(
        dataclasses.replace(
            found,
            columns=scene_model.ALL_QUANTITIES,
            object_quantities=scene_model.ALL_OBJECT_QUANTITIES,
        )
    )
    for (key, kind), names in everything.items():
        if any(fnmatchcase(name, pattern) for name in names):
            return f"it is among {kind}, which record.{key} does not list"
    known = [name for names in everything.values() for name in names]
    return did_you_mean(pattern, known) or f"columns are called like '{known[0]}'"


def _column_names_by_kind(found: Scene) -> Mapping[tuple[str, str], Sequence[str]]:
    """Return the names of all columns by the key of record and the kind; `only` left aside."""
    recorded = columns.Recorded(
        tuple((one.name, one.compiled.chain) for one in found.manipulators),
        tuple(one.name for one in found.objects),
        found.ground is not None,
        found.columns,
        found.object_quantities if found.objects else (),
    )
    names: dict[tuple[str, str], list[str]] = {}
    for group in columns.body_column_groups(recorded):
        names.setdefault(("columns", group.quantity), []).extend(group.selection.names)
    for of_object in columns.object_column_groups(recorded):
        names.setdefault(("objects", of_object.quantity), []).extend(of_object.selection.names)
    return names


def is_ground_name_ambiguous(found: Scene) -> bool:
    """Whether in columns and events of contacts the ground could be taken for something else."""
    names = [one.name for one in found.manipulators] + [one.name for one in found.objects]
    return found.ground is not None and GROUND_NAME in names


def _ground_problems(
    document: Document, found: Scene, has_contact_events: bool
) -> Iterator[Problem]:
    """Refuse to tell the ground from something else that is called so."""
    names_ground = has_contact_events or "contact_pairs" in (
        *found.columns,
        *found.object_quantities,
    )
    if not names_ground or not is_ground_name_ambiguous(found):
        return
    for index, manipulator in enumerate(found.manipulators):
        if manipulator.name == GROUND_NAME:
            yield Problem(
                document.span(("manipulators", index)),
                "a manipulator is called ground, as is the ground in columns of contacts",
                "give it another name",
            )
    for index, rigid_object in enumerate(found.objects):
        if rigid_object.name == GROUND_NAME:
            yield Problem(
                document.span(("objects", index, "name")),
                "an object is called ground, as is the ground in columns of contacts",
                "give it another name",
            )
