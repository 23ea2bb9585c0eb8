"""Plots of trajectories and sweeps: what is on the axes, and that bytes are reproducible."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from somo_cli.document.table import Table, read_table
from somo_cli.plot import canvas, names, sweeps, trajectories
from somo_cli.plot.sweep_table import is_class, read_sweep_table
from somo_cli.problems import InvalidFile
from somo_cli.scene.column_units import unit_of
from somo_cli.scene.quantities import BODY_COLUMNS, OBJECT_COLUMNS
from tests.builders.command import Somo

pytest.importorskip("matplotlib")

CSV = """\
time_s,a.joint_01.angle_rad,a.joint_02.angle_rad,a.tip.x_m,a.tip.y_m,a.contact.normal_n,b.pose.z_m
0,0,0.1,0,0.1,0,0.03
1,0.2,0.3,0.1,0.2,1.5,0.04
2,0.4,0.5,0.2,0.2,2.5,0.05
"""
SWEEP = """\
run,size,mass,grip,lifted,status,findings,reason,run_time_s
0,0.02,1,0.5,true,done,,,0.1
1,0.02,10,0.25,false,done,,,0.1
2,0.04,1,1.5,true,done,,,0.1
3,0.04,10,,,diverged,,"step 3: too fast, far",0.1
"""
ABOUT = """{
"parameters": [{"name": "size", "spacing": "values"}, {"name": "mass", "spacing": "log"}],
"labels": [{"name": "grip", "unit": "N"}, {"name": "lifted", "unit": null}]}"""


@pytest.fixture
def table() -> Table:
    return read_table(CSV, "run.csv")


@pytest.mark.parametrize(
    ("column", "unit"),
    [
        *(
            ("a.tip.x_m", "m"),
            ("b.velocity.x_m_per_s", "m/s"),
            ("c.normal_n", "N"),
            ("time_s", "s"),
        ),
        *(("a.joint_01.rate_rad_per_s", "rad/s"), ("a.pose.qx", ""), ("a.torque_nm", "N·m")),
        *(("a.contact.ball.friction_x_n", "N"), ("a.energy.kinetic_j", "J")),
    ],
)
def test_units(column: str, unit: str) -> None:
    assert unit_of(column) == unit


def test_every_column_that_can_be_recorded_has_its_unit() -> None:
    parts = [
        part for one in (BODY_COLUMNS, OBJECT_COLUMNS) for x in one.values() for part in x.parts
    ]
    without = {part.rpartition(".")[2] for part in parts if not unit_of(f"a.{part}")}
    assert without == {"qx", "qy", "qz", "qw"}


def test_a_trajectory_has_its_standard_panels(table: Table) -> None:
    panels = names.standard_panels(table.names)
    assert [(panel.label, len(panel.columns)) for panel in panels] == [
        *(("a: joints [rad]", 2), ("a tip [m]", 2), ("contact force [N]", 1), ("height [m]", 1))
    ]
    with canvas.drawing():
        axes = trajectories.figure_of({"run": table}, panels, "time_s").axes
        assert [one.get_ylabel() for one in axes] == [panel.label for panel in panels]
        assert [one.get_xlabel() for one in axes] == ["", "", "", "time [s]"]
        np.testing.assert_array_equal(axes[1].lines[1].get_ydata(), [0.1, 0.2, 0.2])
        assert [text.get_text() for text in axes[1].get_legend().get_texts()] == ["x", "y"]


def test_columns_by_pattern_over_another_column(table: Table) -> None:
    columns = names.matching(table.names, ["a.tip.*", "a.contact.normal_n"])
    panels = names.panels_by_unit(columns)
    assert [panel.label for panel in panels] == ["value [m]", "a.contact.normal_n [N]"]
    with canvas.drawing():
        other = trajectories.figure_of({"one": table, "two": table}, panels, "a.tip.x_m")
        assert other.axes[0].get_legend().get_texts()[1].get_text() == "two"
        assert other.axes[-1].get_xlabel() == "a.tip.x_m [m]"
        np.testing.assert_array_equal(other.axes[0].lines[0].get_xdata(), [0, 0.1, 0.2])
    with pytest.raises(ValueError, match=r"'a.tip.w' has no|no column matches 'a.tip.w'; did you"):
        names.matching(table.names, ["a.tip.w"])


def test_a_legend_leaves_out_what_all_have_in_common() -> None:
    assert list(names.short_names(["a.tip.x_m", "a.tip.y_m"]).values()) == ["x", "y"]
    forces = ["left.contact.normal_n", "right.contact.normal_n"]
    assert list(names.short_names(forces).values()) == ["left", "right"]


def test_a_map_has_classes_or_a_scale() -> None:
    swept = read_sweep_table(SWEEP, "results.csv", ABOUT)
    with canvas.drawing():
        figure = sweeps.heat_figure(swept, "size", "mass", "lifted", None)
        (axes,) = figure.axes
        cells = axes.collections[0].get_array()
        np.testing.assert_array_equal(cells.filled(-1), [[1, 1], [0, -1]])
        texts = [text.get_text() for text in figure.legends[0].get_texts()]
        assert texts == ["lifted: false", "lifted: true"]
        assert [text.get_text() for text in axes.get_xticklabels()] == ["0.02", "0.04"]
        scale = sweeps.heat_figure(swept, "size", "mass", "grip", None).axes[1]
        assert scale.get_ylabel() == "grip [N]"
        parts = sweeps.heat_figure(swept, "size", "grip", "status", "mass").axes
        assert [one.get_title() for one in parts] == ["mass = 1", "mass = 10"]


def test_lines_have_a_logarithmic_axis_for_a_logarithmic_parameter() -> None:
    swept = read_sweep_table(SWEEP, "results.csv", ABOUT)
    with canvas.drawing():
        (axes,) = sweeps.lines_figure(swept, "mass", "grip", "size").axes
        assert (axes.get_xscale(), axes.get_xlabel(), axes.get_ylabel()) == (
            *("log", "mass", "grip [N]"),
        )
        assert [line.get_label() for line in axes.lines] == ["size = 0.02", "size = 0.04"]
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), [0.5, 0.25])


def test_what_varies_as_well_is_told() -> None:
    swept = read_sweep_table(SWEEP, "results.csv", ABOUT)
    with pytest.raises(ValueError, match="size vary as well"):
        sweeps.draw_lines(swept, "mass", "grip", None, "png")
    held = swept.where("size", "2e-2")
    assert sweeps.draw_lines(held, "mass", "grip", None, "png").startswith(b"\x89PNG")
    with pytest.raises(ValueError, match=r"no row has size=3; values: 0.02, 0.04"):
        swept.where("size", "3")
    with pytest.raises(ValueError, match="there is no column 'gripp'; did you mean 'grip'"):
        sweeps.draw_heat(swept, "size", "mass", "gripp", "png")


def test_a_row_of_another_length_is_told_with_its_line() -> None:
    with pytest.raises(InvalidFile) as caught:
        read_sweep_table(SWEEP + "4,5\n", "results.csv", None)
    (problem,) = caught.value.problems
    assert (problem.span.line, problem.message) == (6, "this row has 2 cells, the header 9")
    assert is_class(["true", ""])
    assert not is_class(["1", "0.5", ""])


@pytest.mark.parametrize("kind", canvas.FORMATS)
def test_the_same_numbers_make_the_same_bytes(table: Table, kind: str) -> None:
    panels = names.standard_panels(table.names)
    first = trajectories.draw({"run": table}, panels, "time_s", kind)
    assert trajectories.draw({"run": table}, panels, "time_s", kind) == first


@pytest.mark.moderate
def test_the_command_and_its_mistakes(somo: Somo, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(CSV, "utf-8")
    (tmp_path / "results.csv").write_text(SWEEP, "utf-8")
    (tmp_path / "study.json").write_text(ABOUT, "utf-8")
    drawn = somo("plot", "run.csv", "run.csv", "--y", "*.tip.*", "-o", "a.svg")
    assert (drawn.returncode, drawn.stdout, drawn.stderr) == (0, "", "a.svg: SVG\n")
    swept = somo("plot", "results.csv", "--heat", "size,mass", "--value", "lifted", "-q")
    assert (swept.returncode, swept.stderr) == (0, "")
    assert (tmp_path / "results.png").read_bytes().startswith(b"\x89PNG")
    for options, code, message in (
        (("run.csv", "-o", "run.csv"), 2, "does not end with .png, .svg, .pdf"),
        (("run.csv", "--y", "a.tipp.*"), 2, "no column matches 'a.tipp.*'"),
        (("run.csv", "--value", "a"), 2, "it is for --heat or --lines"),
        (("results.csv", "--heat", "size", "--value", "grip"), 2, "'size' is not X,Y"),
        (("results.csv", "--lines", "sizes", "--value", "grip"), 2, "did you mean 'size'"),
        (("none.csv",), 5, "none.csv: No such file"),
        (("results.csv",), 3, "results.csv:2:"),
    ):
        ended = somo("plot", *options)
        assert ended.returncode == code, ended.stderr
        assert message in " ".join(ended.stderr.split())
