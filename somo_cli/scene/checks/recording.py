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


def recording_problems(document: Document, scene: Scene) -> Iterator[Problem]:
    """Yield the errors of what a scene records; the scene has no other errors."""
    yield from _ground_problems(document, scene)
    for index, hint in unmatched_patterns(scene, scene.only):
        place = document.span(("record", "only", index))
        yield Problem(place, f"no column matches '{scene.only[index]}'", hint)


def select_by_patterns(scene: Scene, patterns: Sequence[str]) -> Scene:
    """Return the scene recording, of all columns that there are, those that match a pattern.

    Raises ValueError for a pattern that matches none, and where a name would be ambiguous.
    """
    if is_ground_name_ambiguous(scene):
        raise ValueError(AMBIGUOUS_GROUND)
    whole = _with_all_quantities(scene)
    for index, hint in unmatched_patterns(whole, patterns):
        raise ValueError(f"no column matches {patterns[index]!r}; {hint}")
    return dataclasses.replace(whole, only=tuple(patterns))


def unmatched_patterns(scene: Scene, patterns: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield the index of each pattern that matches none of the scene's columns, and a hint."""
    if not patterns:
        return
    offered = [name for names in _column_names_by_quantity(scene).values() for name in names]
    for index, pattern in enumerate(patterns):
        if not any(fnmatchcase(name, pattern) for name in offered):
            yield index, _unmatched_hint(scene, pattern)


def _unmatched_hint(scene: Scene, pattern: str) -> str:
    everything = _column_names_by_quantity(_with_all_quantities(scene))
    for (key, quantity), names in everything.items():
        if any(fnmatchcase(name, pattern) for name in names):
            return f"it is among {quantity}, which record.{key} does not list"
    known = [name for names in everything.values() for name in names]
    return did_you_mean(pattern, known) or f"columns are called like '{known[0]}'"


def _with_all_quantities(scene: Scene) -> Scene:
    return dataclasses.replace(
        scene,
        columns=scene_model.ALL_QUANTITIES,
        object_quantities=scene_model.ALL_OBJECT_QUANTITIES,
    )


def _column_names_by_quantity(found: Scene) -> Mapping[tuple[str, str], Sequence[str]]:
    """Return the names of the columns that `only` chooses from, by key of `record` and quantity."""
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


def _ground_problems(document: Document, found: Scene) -> Iterator[Problem]:
    """Yield an error for everything called ground, where the recording names what touches."""
    names_ground = found.has_contact_events or "contact_pairs" in (
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
