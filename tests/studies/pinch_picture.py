"""The picture of the pinch grasp: the map of the blocks lifted, and one grasp over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib import style
from matplotlib.axes import Axes

from tests.studies import drawing
from tests.studies.pinch import HEIGHTS, LIFTED, WIDTHS, Grasp
from tests.studies.running import Record


def draw(
    grasps: Mapping[tuple[float, float], Grasp], records: Sequence[Record], path: Path
) -> None:
    """Write the picture, from the grasps of a map and runs of one grasp at two steps."""
    with style.context("default"):
        figure = drawing.new_figure(7.5, 3.6)
        left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
        _map(left, grasps)
        _forces(right, records)
        drawing.save(figure, path)


def _map(axes: Axes, grasps: Mapping[tuple[float, float], Grasp]) -> None:
    rises = [[1e3 * grasps[height, width].rise for width in WIDTHS] for height in HEIGHTS]
    axes.imshow(np.array(rises) > 1e3 * LIFTED, cmap="Blues", vmin=0, vmax=2.5, aspect="auto")
    axes.invert_yaxis()
    for row, line in enumerate(rises):
        for column, rise in enumerate(line):
            axes.text(column, row, f"{round(rise) + 0.0:.0f}", ha="center", va="center", fontsize=8)
    axes.set_xticks(range(len(WIDTHS)), [f"{1e3 * width:.0f}" for width in WIDTHS])
    axes.set_yticks(range(len(HEIGHTS)), [f"{1e3 * height:.0f}" for height in HEIGHTS])
    axes.set_xlabel("width of the block [mm]")
    axes.set_ylabel("height of the hand [mm]")
    axes.set_title(f"rise [mm]; blue: lifted by more than {1e3 * LIFTED:.0f}", fontsize=10)


def _forces(axes: Axes, records: Sequence[Record]) -> None:
    for record, colour, line in zip(records, ("tab:blue", "tab:orange"), ("-", "--"), strict=True):
        step = record["time_s"][-1] / record.summary.steps
        label = f"normal force, {1e3 * step:g} ms"
        force = record["left.contact.normal_n"]
        axes.plot(record["time_s"], force, line, color=colour, linewidth=1, label=label)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("on the left finger [N]")
    rise = axes.twinx()
    height = records[0]["block.pose.z_m"]
    rise.plot(records[0]["time_s"], 1e3 * (height - height[0]), color="0.6", linewidth=1)
    rise.set_ylabel("rise of the block [mm] (grey)", color="0.4")
    axes.set_title("block of 60 mm, hand at 160 mm", fontsize=10)
    axes.legend(fontsize=8, loc="lower right")
