"""The picture of the arm that plays with a ball: the path of the ball, and of the arm's tip."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from matplotlib import style

from tests.studies import drawing
from tests.studies.ball_arm import GOAL, positions
from tests.studies.running import Record


def draw(records: Mapping[str, Record], path: Path) -> None:
    """Write the picture, from runs by their names: first as lines, then dashed over them."""
    with style.context("default"):
        figure = drawing.new_figure(7.5, 4.0)
        paths, heights = figure.subplots(2, 1, sharex=True)
        for (name, record), line in zip(records.items(), ("-", "--"), strict=True):
            for of, colour in (("ball", "tab:orange"), ("tip", "tab:blue")):
                column = {"ball": "ball.pose", "tip": "ball_arm.tip"}[of]
                places = positions(record, column)
                time, label = record["time_s"], f"{of}, {name}"
                paths.plot(
                    time,
                    places[:, 0],
                    line,
                    color=colour if line == "-" else "black",
                    linewidth=1.2,
                    label=label,
                )
                heights.plot(
                    time,
                    places[:, 2],
                    line,
                    color=colour if line == "-" else "black",
                    linewidth=1.2,
                )
        paths.axhline(GOAL, color="0.6", linewidth=1, label="goal line")
        paths.set_ylabel("x [m]")
        paths.legend(fontsize=8, ncols=2)
        heights.set_ylabel("height [m]")
        heights.set_xlabel("time [s]")
        drawing.save(figure, path)
