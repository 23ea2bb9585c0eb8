"""The figure of the in-hand study: the cube's turn over time, and what it depends on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tests.studies import drawing
from tests.studies.in_hand_turn import CYCLE, CYCLES, PREFIX, Turn

MARKERS = "osD^vPX*"


def draw(
    path: Path,
    runs: Sequence[Turn],
    flat: Sequence[Turn],
    measured: float,
    rates: Mapping[str, Mapping[float, float]],
) -> None:
    """Draw all runs, and the turn a cycle over what is changed.

    `runs` are those on pads, `flat` those on a flat palm. `measured` is that of the real hand,
    `rates` are by name and by the factor on the scene's value, all in degrees a cycle.
    """
    figure = drawing.new_figure(8.5, 3.8)
    left, right = figure.subplots(1, 2)
    _over_time(left, runs, flat, measured)
    _over_values(right, measured, rates)
    for axes in (left, right):
        axes.legend(fontsize=7)
    drawing.save(figure, path)


def _over_time(axes: Any, runs: Sequence[Turn], flat: Sequence[Turn], measured: float) -> None:
    kinds = ((flat, "tab:orange", "flat palm"), (runs, "tab:blue", "palm with pads"))
    for group, color, name in kinds:
        for number, run in enumerate(group):
            label = f"{name}, {len(group)} runs" if number == 0 else None
            axes.plot(run.times, run.yaw, color=color, linewidth=0.6, label=label)
    ends = (PREFIX, PREFIX + CYCLES * CYCLE)
    axes.plot(ends, (0, CYCLES * measured), "k--", linewidth=1, label="the real hand, mean rate")
    drawing.panel(axes, "time [s]", "the cube has turned [°]")


def _over_values(axes: Any, measured: float, rates: Mapping[str, Mapping[float, float]]) -> None:
    axes.axhline(measured, linestyle="--", color="k", linewidth=1, label="the real hand")
    for marker, (name, parts) in zip(MARKERS, rates.items(), strict=False):
        values = dict(sorted(parts.items()))
        axes.semilogx(values.keys(), values.values(), marker=marker, markersize=4, linewidth=0.8,
                      label=name)  # fmt: skip
    ticks = (0.5, 0.7, 1, 1.5, 2, 3, 5)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    drawing.panel(axes, "value over that of the scene", "turn a cycle [°]")
    axes.set_ylim(bottom=0)
