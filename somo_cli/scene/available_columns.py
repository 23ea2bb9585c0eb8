"""What a scene can record: every quantity of every manipulator and object, and its columns."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.scene import columns
from somo_cli.scene.column_units import unit_of
from somo_cli.scene.model import ALL_OBJECT_QUANTITIES, ALL_QUANTITIES, Scene


@dataclass(frozen=True, slots=True)
class AvailableColumns:
    """The columns of one quantity of one manipulator or object.

    `key` is where a scene asks for it: record.columns for manipulators, record.objects for objects.
    `recorded` counts the columns that the scene records as it is.
    """

    owner: str
    key: str
    quantity: str
    names: tuple[str, ...]
    recorded: int

    @property
    def units(self) -> tuple[str, ...]:
        """The units of the columns, each once; those without one, as of quaternions, are "1"."""
        return tuple(dict.fromkeys(unit_of(name) or "1" for name in self.names))


def available_columns(scene: Scene) -> Sequence[AvailableColumns]:
    """Return what a scene can record, in the order of the columns."""
    everything = dataclasses.replace(
        scene, columns=ALL_QUANTITIES, object_quantities=ALL_OBJECT_QUANTITIES, only=()
    )
    recorded = set(columns.header(recorded_of(scene)))
    whole = recorded_of(everything)
    found: list[tuple[str, str, str, tuple[str, ...]]] = [
        (whole.names[group.body], "record.columns", group.quantity, group.selection.names)
        for group in columns.body_column_groups(whole)
    ]
    found += [
        (whole.objects[group.object_index], "record.objects", group.quantity, group.selection.names)
        for group in columns.object_column_groups(whole)
    ]
    return [
        AvailableColumns(owner, key, quantity, names, len(recorded.intersection(names)))
        for owner, key, quantity, names in found
    ]


def recorded_of(scene: Scene) -> columns.Recorded:
    """Return what a scene records, its pattern of columns included."""
    return columns.Recorded(
        tuple((one.name, one.compiled.chain) for one in scene.manipulators),
        tuple(one.name for one in scene.objects),
        scene.ground is not None,
        scene.columns,
        scene.object_quantities if scene.objects else (),
        scene.only,
    )
