"""Draw the table of a sweep: a value over two parameters, or lines of it over one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from somo_cli.arrays import Array
from somo_cli.plot import canvas
from somo_cli.plot.names import with_unit
from somo_cli.plot.sweep_table import SweepTable, is_class, number_of

_HEIGHT = 2.1  # in
_MOST_PANELS = 9
_CLASSES = ("#D9D9D9", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")


def draw_heat(table: SweepTable, x: str, y: str, value: str, kind: str) -> bytes:
    """Return a picture of a value over two parameters; classes get a legend, numbers a scale.

    If a third parameter varies, each of its values has a panel. Raises ValueError if more vary, or
    for an unknown column, and ExtraMissing.
    """
    third = _others(table, (x, y))
    if len(third) > 1:
        raise ValueError(f"{', '.join(third)} vary as well; hold all but one with --at NAME=VALUE")
    with canvas.drawing():
        return canvas.image(heat_figure(table, x, y, value, third[0] if third else None), kind)


def draw_lines(table: SweepTable, x: str, value: str, by: str | None, kind: str) -> bytes:
    """Return a picture of a value over a parameter, a line for each value of another.

    Raises ValueError if more parameters vary, or for an unknown column, and ExtraMissing.
    """
    others = _others(table, (x, by) if by else (x,))
    if others:
        raise ValueError(f"{', '.join(others)} vary as well; hold them with --at NAME=VALUE")
    with canvas.drawing():
        return canvas.image(lines_figure(table, x, value, by), kind)


def heat_figure(table: SweepTable, x: str, y: str, value: str, third: str | None) -> Any:
    """Return the figure of `draw_heat`; to be called in `canvas.drawing`."""
    parts: list[tuple[str | None, SweepTable]] = [(None, table)]
    if third is not None:
        levels = _levels(table.column(third))
        if len(levels) > _MOST_PANELS:
            raise ValueError(f"{third} has {len(levels)} values; hold it with --at {third}=VALUE")
        parts = [(level, table.where(third, level)) for level in levels]
    figure, axes = canvas.panels(len(parts), _HEIGHT, 2 if len(parts) <= 4 else 3, across=True)
    classes = _classes(table, value)
    numbers = [number_of(text) for text in table.column(value)]
    limits = (
        min(filter(_is_known, numbers), default=0),
        max(filter(_is_known, numbers), default=1),
    )
    mesh = None
    for (level, part), one in zip(parts, axes, strict=True):
        mesh = _heat(one, part, (x, y, value), classes, limits)
        one.set_xlabel(with_unit(x, table.units.get(x, "")))
        one.set_ylabel(with_unit(y, table.units.get(y, "")))
        if level is not None:
            one.set_title(f"{third} = {_shortest(level)}", fontsize=7.5)
    label = with_unit(value, table.units.get(value, ""))
    if classes:
        from matplotlib.patches import Patch

        patches = [
            Patch(color=_CLASSES[number % len(_CLASSES)], label=f"{label}: {name}")
            for number, name in enumerate(classes)
        ]
        figure.legend(handles=patches, loc="outside lower center", ncols=min(3, len(classes)))
    else:
        figure.colorbar(mesh, ax=axes, label=label, shrink=0.9)
    return figure


def lines_figure(table: SweepTable, x: str, value: str, by: str | None) -> Any:
    """Return the figure of `draw_lines`; to be called in `canvas.drawing`."""
    figure, (axes,) = canvas.panels(1, _HEIGHT)
    levels: Sequence[str | None] = [None] if by is None else _levels(table.column(by))
    for number, level in enumerate(levels):
        part = table if by is None or level is None else table.where(by, level)
        pairs = sorted(
            (number_of(one), number_of(other))
            for one, other in zip(part.column(x), part.column(value), strict=True)
        )
        axes.plot(
            [one for one, _ in pairs],
            [other for _, other in pairs],
            marker="osD^vP*X"[number % 8],
            markersize=3,
            color=canvas.COLORS[number % len(canvas.COLORS)],
            label=None if level is None else f"{by} = {_shortest(level)}",
        )
    if table.spacings.get(x) == "log":
        axes.set_xscale("log")
    axes.set_xlabel(with_unit(x, table.units.get(x, "")))
    axes.set_ylabel(with_unit(value, table.units.get(value, "")))
    if by is not None:
        axes.legend()
    return figure


def _heat(
    axes: Any,
    table: SweepTable,
    columns: tuple[str, str, str],
    classes: Sequence[str],
    limits: tuple[float, float],
) -> Any:
    """Draw one map: a cell for each pair of values, empty where no run has it."""
    from matplotlib.colors import ListedColormap

    x, y, _ = columns
    across, up = (_levels(table.column(name)) for name in (x, y))
    cells: Array = np.full((len(up), len(across)), np.nan)
    texts = [table.column(name) for name in columns]
    for one, other, text in zip(*texts, strict=True):
        number = classes.index(text) if text in classes else number_of(text)
        cells[up.index(other), across.index(one)] = number
    colors = ListedColormap([_CLASSES[n % len(_CLASSES)] for n in range(len(classes))])
    mesh = axes.pcolormesh(
        np.arange(len(across) + 1),
        np.arange(len(up) + 1),
        cells,
        cmap=colors if classes else "viridis",
        vmin=-0.5 if classes else limits[0],
        vmax=len(classes) - 0.5 if classes else limits[1],
        edgecolors="white",
        linewidth=0.4,
    )
    axes.set_xticks(np.arange(len(across)) + 0.5, map(_shortest, across))
    axes.set_yticks(np.arange(len(up)) + 0.5, map(_shortest, up))
    axes.grid(visible=False)
    return mesh


def _levels(texts: Sequence[str]) -> list[str]:
    """Return the values of a parameter, numbers in their order."""
    found = list(dict.fromkeys(texts))
    return found if is_class(found) else sorted(found, key=number_of)


def _classes(table: SweepTable, value: str) -> list[str]:
    """Return the classes that a column names, none if it holds numbers."""
    texts = table.column(value)
    return sorted({text for text in texts if text}) if is_class(texts) else []


def _others(table: SweepTable, used: Sequence[str]) -> list[str]:
    """Return the parameters beside those used that have more than one value."""
    for name in used:
        table.column(name)
    return [
        name
        for name in table.parameters
        if name not in used
        and table.spacings[name] != "expression"
        and len(set(table.column(name))) > 1
    ]


def _is_known(number: float) -> bool:
    return not math.isnan(number)


def _shortest(text: str) -> str:
    number = number_of(text)
    return text if math.isnan(number) or text in ("true", "false") else f"{number:.4g}"
