"""Columns of a table in units that labs write, such as kPa, mN and mm, converted to SI."""

from __future__ import annotations

import dataclasses
import math

from somo_cli.document.table import Table

_UNITS: dict[str, tuple[str, float]] = {
    "kpa": ("pa", 1e3),
    "mpa": ("pa", 1e6),
    "bar": ("pa", 1e5),
    "mbar": ("pa", 1e2),
    "psi": ("pa", 6894.757293168361),
    "mm": ("m", 1e-3),
    "cm": ("m", 1e-2),
    "mm_per_s": ("m_per_s", 1e-3),
    "mn": ("n", 1e-3),
    "mnm": ("nm", 1e-3),
    "nmm": ("nm", 1e-3),
    "deg": ("rad", math.pi / 180),
    "deg_per_s": ("rad_per_s", math.pi / 180),
    "ms": ("s", 1e-3),
}
"""The ends of names that are converted: the end in SI, and the factor; mpa is 1e6 Pa, mn 1e-3 N."""


def in_si(table: Table) -> tuple[Table, list[str]]:
    """Return a table with the columns of `_UNITS` in SI and renamed, and in words what was done.

    A column stays as it is where there is one of its new name.
    """
    columns: dict[str, tuple[float, ...]] = {}
    done = []
    for name in table.names:
        new, factor = _in_si(name)
        if new == name or new in table.columns or new in columns:
            columns[name] = table.columns[name]
            continue
        columns[new] = tuple(factor * value for value in table.columns[name])
        done.append(f"{name} is taken as {new}, times {factor:.7g}")
    return dataclasses.replace(table, names=tuple(columns), columns=columns), done


def _in_si(name: str) -> tuple[str, float]:
    """Return the name of a column in SI, and the factor to it."""
    ends = [end for end in _UNITS if name.endswith(f"_{end}")]
    if not ends:
        return name, 1.0
    end = max(ends, key=len)
    unit, factor = _UNITS[end]
    return name.removesuffix(end) + unit, factor
