"""The columns of the CSV: their names, and the quantity and body of each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from somo_cli.manipulator.chain import Chain
from somo_cli.scene.column_selection import ColumnSelection, select_columns
from somo_cli.scene.contact_surface import GROUND_NAME
from somo_cli.scene.model import Quantity
from somo_cli.scene.quantities import (
    BODY_COLUMNS,
    FORCE_AND_FRICTION,
    OBJECT_COLUMNS,
    Columns,
    Need,
)
from somo_cli.scene.rigid_object import ObjectQuantity


@dataclass(frozen=True, slots=True)
class Recorded:
    """The bodies and quantities that a run records: all that the columns depend on.

    `manipulators` holds names and chains, in any length unit; `objects` holds names. With
    `patterns`, only columns that match one of them are recorded.
    """

    manipulators: tuple[tuple[str, Chain], ...]
    objects: tuple[str, ...]
    has_ground: bool
    quantities: tuple[Quantity, ...]
    object_quantities: tuple[ObjectQuantity, ...]
    patterns: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of manipulators, objects and the ground; a body's number is its index."""
        return (*(name for name, _ in self.manipulators), *self.objects, GROUND_NAME)

    def contact_partners(self, number: int) -> tuple[int, ...]:
        """Return the numbers of all bodies that can touch body `number`, in the columns' order."""
        count = len(self.manipulators) + len(self.objects) + self.has_ground
        return tuple(other for other in range(count) if other != number)


@dataclass(frozen=True, slots=True)
class BodyColumnGroup:
    """The columns [first, last) of one quantity of one manipulator, all of one unit."""

    body: int
    quantity: Quantity
    first: int
    last: int
    selection: ColumnSelection

    @property
    def columns(self) -> Columns:
        """The description of the columns."""
        return BODY_COLUMNS[self.quantity]


@dataclass(frozen=True, slots=True)
class ObjectColumnGroup:
    """The columns [first, last) of one quantity of one object."""

    object_index: int
    quantity: ObjectQuantity
    first: int
    last: int
    selection: ColumnSelection

    @property
    def columns(self) -> Columns:
        """The description of the columns."""
        return OBJECT_COLUMNS[self.quantity]


ColumnGroup: TypeAlias = BodyColumnGroup | ObjectColumnGroup


def column_groups(recorded: Recorded) -> list[ColumnGroup]:
    """Return the groups of all columns, in the order of the header."""
    return [*body_column_groups(recorded), *object_column_groups(recorded)]


def header(recorded: Recorded) -> list[str]:
    """Return the name of every column, time first; each name ends with its unit."""
    groups = column_groups(recorded)
    return ["time_s", *(name for group in groups for name in group.selection.names)]


def body_column_groups(recorded: Recorded) -> list[BodyColumnGroup]:
    """Return the groups of the columns of manipulators, in the order of the header."""
    found: list[BodyColumnGroup] = []
    first = 1
    for number, (owner, chain) in enumerate(recorded.manipulators):
        for quantity in recorded.quantities:
            own = (
                _pair_names(recorded, number)
                if quantity == "contact_pairs"
                else BODY_COLUMNS[quantity].names(chain)
            )
            chosen = select_columns(recorded.patterns, [f"{owner}.{name}" for name in own])
            if chosen.indices:
                last = first + len(chosen.indices)
                found.append(BodyColumnGroup(number, quantity, first, last, chosen))
                first = last
    return found


def object_column_groups(recorded: Recorded) -> list[ObjectColumnGroup]:
    """Return the groups of the columns of objects, which follow those of manipulators."""
    found: list[ObjectColumnGroup] = []
    first = max((group.last for group in body_column_groups(recorded)), default=1)
    for number, owner in enumerate(recorded.objects):
        for quantity in recorded.object_quantities:
            own: Sequence[str] = (
                _pair_names(recorded, len(recorded.manipulators) + number)
                if quantity == "contact_pairs"
                else OBJECT_COLUMNS[quantity].parts
            )
            chosen = select_columns(recorded.patterns, [f"{owner}.{name}" for name in own])
            if chosen.indices:
                last = first + len(chosen.indices)
                found.append(ObjectColumnGroup(number, quantity, first, last, chosen))
                first = last
    return found


def needs_of(groups: Sequence[ColumnGroup]) -> frozenset[Need]:
    """Return the state that these columns need, of what only some columns need."""
    return frozenset(need for group in groups for need in group.columns.needs)


def quaternion_columns(recorded: Recorded) -> Iterator[tuple[int, ...]]:
    """Yield the recorded column numbers of each unit quaternion; time is column 0."""
    for group in column_groups(recorded):
        start = group.columns.quaternion_start
        if start is None:
            continue
        by_quaternion: dict[int, list[int]] = {}
        for column, index in enumerate(group.selection.indices, start=group.first):
            if index >= start:
                by_quaternion.setdefault((index - start) // 4, []).append(column)
        yield from map(tuple, by_quaternion.values())


def base_pose_names(owner: str) -> list[str]:
    """Return the column names of the pose of a manipulator's base: position, quaternion."""
    return [f"{owner}.{part}" for part in BODY_COLUMNS["base_pose"].parts]


def _pair_names(recorded: Recorded, number: int) -> list[str]:
    """Return the column names of the force of each contact partner on body `number`."""
    names = recorded.names
    return [
        f"contact.{names[other]}.{part}"
        for other in recorded.contact_partners(number)
        for part in FORCE_AND_FRICTION
    ]
