"""Check what a scene records: patterns that match no column, and ambiguous names."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase

from somo_cli.document.parse import Document
from somo_cli.problems import Problem, did_you_mean
from somo_cli.scene import columns
from somo_cli.scene import model as scene_model
from somo_cli.scene.available_columns import recorded_of
from somo_cli.scene.contact_surface import GROUND_NAME
from somo_cli.scene.model import Scene

AMBIGUOUS_GROUND = (
    "a manipulator or object is called ground, which is the ground's name in contacts: rename it"
)


def recording_problems(document: Document, scene: Scene) -> Iterator[Problem]:
    """Yield the errors in what a scene records; the scene must have no other errors."""
    yield from _ground_problems(document, scene)
    for index, hint in unmatched_patterns(scene, scene.only):
        place = document.span(("record", "only", index))
        yield Problem(place, f"no column matches '{scene.only[index]}'", hint)


def select_by_patterns(scene: Scene, patterns: Sequence[str]) -> Scene:
    """Return the scene with every column recorded that matches one of the patterns.

    Raises ValueError if a pattern matches no column, or if a name would be ambiguous.
    """
    if is_ground_name_ambiguous(scene):
        raise ValueError(AMBIGUOUS_GROUND)
    whole = _with_all_quantities(scene)
    for index, hint in unmatched_patterns(whole, patterns):
        raise ValueError(f"no column matches {patterns[index]!r}; {hint}")
    return dataclasses.replace(whole, only=tuple(patterns))


def unmatched_patterns(scene: Scene, patterns: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield, for each pattern that matches none of the scene's columns, its index and a hint."""
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
            return f"it is a column of {quantity}: add {quantity} to record.{key}"
    known = [name for names in everything.values() for name in names]
    return did_you_mean(pattern, known) or f"names of columns look like '{known[0]}'"


def _with_all_quantities(scene: Scene) -> Scene:
    return dataclasses.replace(
        scene,
        columns=scene_model.ALL_QUANTITIES,
        object_quantities=scene_model.ALL_OBJECT_QUANTITIES,
    )


def _column_names_by_quantity(found: Scene) -> Mapping[tuple[str, str], Sequence[str]]:
    """Return the column names that `only` selects from, by key of `record` and quantity."""
    recorded = recorded_of(dataclasses.replace(found, only=()))
    names: dict[tuple[str, str], list[str]] = {}
    for group in columns.body_column_groups(recorded):
        names.setdefault(("columns", group.quantity), []).extend(group.selection.names)
    for of_object in columns.object_column_groups(recorded):
        names.setdefault(("objects", of_object.quantity), []).extend(of_object.selection.names)
    return names


def is_ground_name_ambiguous(found: Scene) -> bool:
    """Return whether a manipulator or object has the name of the ground in contacts."""
    names = [one.name for one in found.manipulators] + [one.name for one in found.objects]
    return found.ground is not None and GROUND_NAME in names


def _ground_problems(document: Document, found: Scene) -> Iterator[Problem]:
    """Yield an error for each body called ground, if the recording names contact partners."""
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
                "a manipulator is called ground, which is the ground's name in contacts",
                "give it another name",
            )
    for index, rigid_object in enumerate(found.objects):
        if rigid_object.name == GROUND_NAME:
            yield Problem(
                document.span(("objects", index, "name")),
                "an object is called ground, which is the ground's name in contacts",
                "give it another name",
            )
