"""Columns that are judged together: one quantity of one body or object, in one unit.

What an error of a column means depends on how far the column moves. A component that stays near
zero, such as the sideways force of a finger that presses straight down, must not be off by 100 %
because of its last digit. So the components of a vector, all joints of a body and all links of a
body share one scale: the largest range among them.

Three measures say how large an error is over a run:

- `largest`: the largest error at any row, for what moves without jumps: positions, angles,
  orientations, torques.
- `mean`: the mean over time of the absolute error, for what jumps at an impact: rates, velocities,
  energies. An impact that comes 1 ms early in a run of 1 s then counts a thousandth of its jump,
  where the largest error would be the whole jump at any step.
- `impulse`: for contact forces, whose peaks grow without bound as the step falls, while their
  integral over time stays. It is the error of the impulse since the start (its mean over time, or
  at the end, whichever is larger) over the duration, and so a force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from somo_cli.scene import columns
from somo_cli.scene.columns import ColumnGroup, Recorded

Measure: TypeAlias = Literal["largest", "mean", "impulse"]

QUATERNION_UNIT = "1"
UNITS_OF_NAMES = (
    ("_rad_per_s", "rad/s"),
    ("_m_per_s", "m/s"),
    ("_per_m", "1/m"),
    ("_rad", "rad"),
    ("_nm", "N·m"),
    ("_n", "N"),
    ("_j", "J"),
    ("_m", "m"),
)
"""How the name of a column ends, and its unit; the components of a quaternion have none."""


@dataclass(frozen=True, slots=True)
class ColumnFamily:
    """The columns of one quantity of one body or object in one unit; time is column 0."""

    name: str
    unit: str
    measure: Measure
    columns: tuple[int, ...]


def column_families(recorded: Recorded) -> tuple[ColumnFamily, ...]:
    """Return the families of all columns but the time, in the order of their first columns."""
    names = columns.header(recorded)
    found = []
    for group in columns.column_groups(recorded):
        by_unit: dict[str, list[int]] = {}
        for column in range(group.first, group.last):
            by_unit.setdefault(unit_of(names[column]), []).append(column)
        owner = names[group.first].split(".", 1)[0]
        for unit, members in by_unit.items():
            name = f"{owner} {group.quantity}"
            found.append(ColumnFamily(name, unit, _measure(group), tuple(members)))
    return tuple(found)


def force_columns(recorded: Recorded) -> tuple[int, ...]:
    """Return the columns of contact forces, which are judged by their impulses."""
    families = column_families(recorded)
    return tuple(c for one in families if one.measure == "impulse" for c in one.columns)


def unit_of(name: str) -> str:
    """Return the unit of a column by the end of its name."""
    return next((unit for end, unit in UNITS_OF_NAMES if name.endswith(end)), QUATERNION_UNIT)


def _measure(group: ColumnGroup) -> Measure:
    if "contacts" in group.columns.needs:
        return "impulse"
    return "mean" if "velocities" in group.columns.needs else "largest"
