"""The names of columns: what they are of, their unit, and the panels that they belong to."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from somo_cli.problems import did_you_mean
from somo_cli.scene.column_units import unit_of

_ANGLE = re.compile(r"(?P<body>[^.]+)\.[^.]*joint[^.]*\.angle_rad")
_TIP = re.compile(r"(?P<body>.+tip)\.[xyz]_m")


@dataclass(frozen=True, slots=True)
class Panel:
    """Columns that share an axis, in the order of the file, and the text of the axis."""

    label: str
    columns: tuple[str, ...]


def with_unit(name: str, unit: str) -> str:
    """Return the text of an axis, such as "tip [m]"."""
    return f"{name} [{unit}]" if unit else name


def standard_panels(names: Sequence[str]) -> tuple[Panel, ...]:
    """Return the panels of a trajectory: joint angles, tips, contact forces, heights of objects.

    If there is nothing of these, all columns are grouped by their unit.
    """
    angles: dict[str, list[str]] = {}
    tips: dict[str, list[str]] = {}
    for name in names:
        for pattern, found in ((_ANGLE, angles), (_TIP, tips)):
            match = pattern.fullmatch(name)
            if match:
                found.setdefault(match["body"], []).append(name)
    panels = [Panel(f"{body}: joints [rad]", tuple(one)) for body, one in angles.items()]
    panels += [Panel(f"{body.replace('.', ' ')} [m]", tuple(one)) for body, one in tips.items()]
    forces = tuple(name for name in names if name.endswith(".contact.normal_n"))
    heights = tuple(name for name in names if name.endswith(".pose.z_m"))
    panels += [Panel("contact force [N]", forces)] if forces else []
    panels += [Panel("height [m]", heights)] if heights else []
    return tuple(panels) or panels_by_unit(names[1:])


def panels_by_unit(names: Sequence[str]) -> tuple[Panel, ...]:
    """Return a panel for each unit, with its columns."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(unit_of(name), []).append(name)
    return tuple(
        Panel(with_unit(one[0] if len(one) == 1 else "value", unit), tuple(one))
        for unit, one in groups.items()
    )


def matching(names: Sequence[str], patterns: Sequence[str]) -> tuple[str, ...]:
    """Return the names that match a pattern, in their order; raise ValueError if one has none."""
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in names):
            hint = did_you_mean(pattern, names) or f"names look like '{names[-1]}'"
            raise ValueError(f"no column matches '{pattern}'; {hint}")
    return tuple(name for name in names if any(fnmatchcase(name, pattern) for pattern in patterns))


def short_names(columns: Sequence[str]) -> dict[str, str]:
    """Return names for a legend: without the parts that all of them share, and without units."""
    parts = [name.split(".") for name in columns]
    if len({len(one) for one in parts}) > 1:
        return dict(zip(columns, columns, strict=True))
    kept = [place for place, texts in enumerate(zip(*parts, strict=True)) if len(set(texts)) > 1]
    last = len(parts[0]) - 1
    return {
        name: ".".join(
            one[place].partition("_")[0] if place == last else one[place]
            for place in kept or [last]
        )
        for name, one in zip(columns, parts, strict=True)
    }
