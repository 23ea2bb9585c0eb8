"""Check a motion that a CSV gives; errors have their position in the CSV."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.document.table import Table, read_table, table_problems
from somo_cli.problems import (
    InvalidFile,
    Pointer,
    Problem,
    counted,
    did_you_mean,
    has_errors,
)
from somo_cli.scene.checks.motion_start import about_problems, pose_problems
from somo_cli.scene.pose_table import (
    ANGLES,
    GROUPS,
    POSITION,
    QUATERNION,
    TIME,
    has_columns,
    read_pose_rows,
)

LENGTH_TOLERANCE = 1e-6
"""Difference of the length of a quaternion from 1 that is rounding."""
MIN_LENGTH = 0.1
"""Length of a quaternion below which it gives no direction."""
MAX_ANGLE_STEP = math.pi  # rad between two rows, for each of roll, pitch and yaw
MAX_QUATERNION_STEP = math.pi / 2  # rad between two rows: beyond it the way is a guess

_KNOWN = (TIME, *POSITION, *ANGLES, *QUATERNION)


def motion_file_problems(
    document: Document, at: Pointer, motion: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield the errors and warnings about the motion at `at`, which a file gives."""
    file = motion["file"]
    try:
        table = read_table(file["text"], file["source"])
    except InvalidFile as error:
        yield from error.problems
        return
    problems = list(_table_problems(table))
    yield from problems
    if has_errors(problems):
        return
    has_rotation = any(has_columns(table, one) for one in (ANGLES, QUATERNION))
    has_position = has_columns(table, POSITION)
    yield from about_problems(document, at, motion, has_rotation)
    if motion.get("frame") == "world" and not (has_position and has_rotation):
        missing = ANGLES if has_position else POSITION
        yield Problem(
            table.header_span(table.names[0]),
            f"frame: world takes whole poses, and there are no columns {', '.join(missing)}",
            "add them, or set frame: start",
        )
        return
    yield from _row_problems(table, motion)


def _row_problems(table: Table, motion: Mapping[str, Any]) -> Iterator[Problem]:
    rows = read_pose_rows(table)
    parts = (
        ("translation", rows.translation),
        ("rotation", rows.rotation),
        ("rotation", rows.quaternions),
    )
    for (part, points), group in zip(parts, GROUPS, strict=True):
        if points:
            yield from pose_problems(motion, part, points, partial(table.cell_span, name=group[0]))


def _table_problems(table: Table) -> Iterator[Problem]:
    """Yield every error and warning of a table of poses but where it starts."""
    errors = [*_column_problems(table)]
    errors += table_problems(table, increasing=TIME)
    yield from errors
    if has_errors(errors):
        return
    errors = list(_direction_problems(table))
    yield from errors
    if not errors:
        yield from _length_warnings(table)
        yield from _turn_warnings(table)


def _column_problems(table: Table) -> Iterator[Problem]:
    for name in table.names:
        if name not in _KNOWN:
            hint = did_you_mean(name, _KNOWN) or f"known columns: {', '.join(_KNOWN)}"
            yield Problem(table.header_span(name), f"'{name}' is no column of a motion", hint)
    yield from _group_problems(table)
    if has_columns(table, ANGLES) and has_columns(table, QUATERNION):
        place = table.header_span(QUATERNION[0])
        yield Problem(place, "the rotation is given twice", f"leave out {', '.join(QUATERNION)}")


def _group_problems(table: Table) -> Iterator[Problem]:
    place = table.header_span(table.names[0])
    found = False
    for group in GROUPS:
        missing = [name for name in group if name not in table.names]
        found = found or len(missing) < len(group)
        if missing and len(missing) < len(group):
            hint = f"{', '.join(group)} come together"
            yield Problem(place, f"there is no column '{missing[0]}'", hint)
    if not found:
        hint = f"give {', '.join(POSITION)}, and {', '.join(ANGLES)} or {', '.join(QUATERNION)}"
        yield Problem(place, "there are no columns of a position or a rotation", hint)


def _quaternions(table: Table) -> list[tuple[float, ...]]:
    if not has_columns(table, QUATERNION):
        return []
    return list(zip(*(table.columns[name] for name in QUATERNION), strict=True))


def _direction_problems(table: Table) -> Iterator[Problem]:
    short = [row for row, one in enumerate(_quaternions(table)) if math.hypot(*one) < MIN_LENGTH]
    if short:
        more = f", and so in {counted(len(short) - 1, 'more row')}" if len(short) > 1 else ""
        message = "this quaternion has no length, so it gives no rotation"
        hint = "no rotation is 0, 0, 0, 1"
        yield Problem(table.cell_span(short[0], QUATERNION[0]), message + more, hint)


def _length_warnings(table: Table) -> Iterator[Problem]:
    lengths = [math.hypot(*one) for one in _quaternions(table)]
    off = [row for row, length in enumerate(lengths) if abs(length - 1) > LENGTH_TOLERANCE]
    if off:
        more = f", and so in {counted(len(off) - 1, 'more row')}" if len(off) > 1 else ""
        yield Problem(
            table.cell_span(off[0], QUATERNION[0]),
            f"this quaternion has a length of {lengths[off[0]]:.9g}, not 1{more}; it is normalised",
            "write quaternions with seven digits or more",
            "warning",
        )


def _turn_warnings(table: Table) -> Iterator[Problem]:
    for name in ANGLES if has_columns(table, ANGLES) else ():
        turns = [abs(after - before) for before, after in pairwise(table.columns[name])]
        far = [row for row, turn in enumerate(turns, start=1) if turn > MAX_ANGLE_STEP]
        if far:
            yield _turn_warning(
                table,
                name,
                far,
                f"'{name}' changes by {turns[far[0] - 1]:.4g} rad since the row before",
                "angles are interpolated as numbers, so this turn is made in full: let them "
                "go on beyond π, or give quaternions",
            )
    turns = [_turn_between(*pair) for pair in pairwise(_quaternions(table))]
    far = [row for row, turn in enumerate(turns, start=1) if turn > MAX_QUATERNION_STEP]
    if far:
        yield _turn_warning(
            table,
            QUATERNION[0],
            far,
            f"the rotation is {turns[far[0] - 1]:.4g} rad away from the row before",
            "it turns the short way, unevenly: give rows that are nearer to each other",
        )


def _turn_warning(table: Table, name: str, rows: Sequence[int], message: str, hint: str) -> Problem:
    more = f", and so in {counted(len(rows) - 1, 'more row')}" if len(rows) > 1 else ""
    return Problem(table.cell_span(rows[0], name), message + more, hint, "warning")


def _turn_between(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the angle of the rotation from one quaternion of any length to another [rad]."""
    dot = abs(math.fsum(a * b for a, b in zip(one, other, strict=True)))
    return 2 * math.acos(min(1.0, dot / (math.hypot(*one) * math.hypot(*other))))
