"""Draw the columns of one or several trajectories over time, or over another column."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from somo_cli.document.table import Table
from somo_cli.plot import canvas
from somo_cli.plot.names import Panel, short_names, with_unit
from somo_cli.scene.column_units import unit_of

_FEW = 8  # lines that a legend can name
_SHORT = 12  # characters of a name that has room beside another
_HEIGHT = 1.35  # in


def draw(tables: Mapping[str, Table], panels: Sequence[Panel], x: str, kind: str) -> bytes:
    """Return a picture of the panels of tables, which have names for a legend.

    Lines of one table have colours of their own; of several, those of one table share its colour.
    Raises ExtraMissing.
    """
    with canvas.drawing():
        return canvas.image(figure_of(tables, panels, x), kind)


def figure_of(tables: Mapping[str, Table], panels: Sequence[Panel], x: str) -> Any:
    """Return the figure of `draw`; to be called in `canvas.drawing`."""
    figure, axes = canvas.panels(len(panels), _HEIGHT)
    for number, (panel, one) in enumerate(zip(panels, axes, strict=True)):
        if len(tables) == 1:
            _draw_alone(one, next(iter(tables.values())), panel, x)
        else:
            _draw_together(one, tables, panel, x, number == 0)
        one.set_ylabel(panel.label)
    label = "time [s]" if x == "time_s" else with_unit(x, unit_of(x))
    for one in axes:
        is_lowest = all(
            other.get_subplotspec().rowspan.start <= one.get_subplotspec().rowspan.start
            or other.get_subplotspec().colspan != one.get_subplotspec().colspan
            for other in axes
        )
        if is_lowest:
            one.set_xlabel(label)
        else:
            one.tick_params(labelbottom=x != "time_s")
    return figure


def _draw_alone(axes: Any, table: Table, panel: Panel, x: str) -> None:
    from matplotlib import colormaps

    names = short_names(panel.columns)
    count = len(panel.columns)
    for number, column in enumerate(panel.columns):
        is_few = count <= _FEW
        color = canvas.COLORS[number] if is_few else colormaps["viridis"](number / (count - 1))
        is_named = is_few or number in (0, count - 1)
        axes.plot(
            table.columns[x],
            table.columns[column],
            color=color,
            linewidth=1.0 if is_few else 0.7,
            label=names[column] if is_named else None,
        )
    if count > 1:
        axes.margins(y=0.15)  # room for the legend
        has_room = 4 < count <= _FEW and max(map(len, names.values())) <= _SHORT
        axes.legend(ncols=2 if has_room else 1)


def _draw_together(
    axes: Any, tables: Mapping[str, Table], panel: Panel, x: str, has_legend: bool
) -> None:
    for number, (name, table) in enumerate(tables.items()):
        for place, column in enumerate(panel.columns):
            axes.plot(
                table.columns[x],
                table.columns[column],
                color=canvas.COLORS[number % len(canvas.COLORS)],
                linestyle=("-", "--", ":", "-.")[place % 4 if len(panel.columns) <= 4 else 0],
                linewidth=0.8,
                label=name if place == 0 else None,
            )
    if has_legend:
        axes.legend()
