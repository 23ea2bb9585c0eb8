"""Poses over time in a table: time, position, and roll, pitch, yaw or a quaternion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.document.table import Table

TIME = "time_s"
POSITION = ("x_m", "y_m", "z_m")
ANGLES = ("roll_rad", "pitch_rad", "yaw_rad")
QUATERNION = ("qx", "qy", "qz", "qw")
GROUPS = (POSITION, ANGLES, QUATERNION)
"""Columns that come together."""

Row4 = tuple[float, float, float, float]
Row5 = tuple[float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class PoseRows:
    """Rows of a table of poses, each with its time [s] first; empty where it has no such columns.

    Positions in metres, roll, pitch and yaw in radians. Quaternions (x, y, z, w) have length 1, and
    each has the sign with which it is nearer to the one before, so that none turns the long way.
    """

    translation: tuple[Row4, ...]
    rotation: tuple[Row4, ...]
    quaternions: tuple[Row5, ...]


def read_pose_rows(table: Table) -> PoseRows:
    """Return the rows of a table that has the columns of poses, and no other."""
    times = table.columns[TIME]
    return PoseRows(
        _rows_of_three(table, times, POSITION),
        _rows_of_three(table, times, ANGLES),
        _aligned_quaternions(table, times),
    )


def has_columns(table: Table, group: Sequence[str]) -> bool:
    """Return whether a table has all columns of a group."""
    return all(name in table.columns for name in group)


def _rows_of_three(table: Table, times: Sequence[float], group: Sequence[str]) -> tuple[Row4, ...]:
    if not has_columns(table, group):
        return ()
    x, y, z = (table.columns[name] for name in group)
    return tuple(zip(times, x, y, z, strict=True))


def _aligned_quaternions(table: Table, times: Sequence[float]) -> tuple[Row5, ...]:
    if not has_columns(table, QUATERNION):
        return ()
    rows: list[Row5] = []
    before = (0.0, 0.0, 0.0, 1.0)  # the first one has w >= 0
    x, y, z, w = (table.columns[name] for name in QUATERNION)
    for time, *values in zip(times, x, y, z, w, strict=True):
        size = math.hypot(*values)
        dot = sum(one * other for one, other in zip(values, before, strict=True))
        signed = size if dot >= 0 else -size
        before = (values[0] / signed, values[1] / signed, values[2] / signed, values[3] / signed)
        rows.append((time, *before))
    return tuple(rows)
