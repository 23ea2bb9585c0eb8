"""somo plot: draw trajectories, and the tables of sweeps."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import files, output_files, terminal
from somo_cli.cli.application import (
    QuietOption,
    app,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_unsafe

if TYPE_CHECKING:
    from somo_cli.document.table import Table
    from somo_cli.plot.sweep_table import SweepTable


@app.command(
    short_help="Plot trajectories, or the table of a sweep.",
    epilog=examples_of(
        "somo plot run.csv",
        "somo plot a.csv b.csv --y 'finger.tip.*' -o tips.pdf",
        "somo plot results.csv --heat pressure,mass --value lifted",
    ),
)
@report_errors
def plot(
    paths: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help="CSVs of somo run, or one results.csv of a sweep."),
    ],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Where to write the picture: .png, .svg or .pdf. [default: the first file's name "
            "with .png, in the current directory]",
        ),
    ] = None,
    ys: Annotated[
        list[str] | None,
        typer.Option(
            "--y",
            metavar="PATTERN",
            help="Draw the columns whose name matches, such as 'finger.tip.*', those of one unit "
            "together. Repeatable. [default: joint angles, tips, contact forces, heights]",
        ),
    ] = None,
    x: Annotated[
        str, typer.Option("--x", metavar="COLUMN", help="Draw over this column.")
    ] = "time_s",
    heat: Annotated[
        str | None,
        typer.Option("--heat", metavar="X,Y", help="Of a sweep: draw --value over two parameters."),
    ] = None,
    lines: Annotated[
        str | None,
        typer.Option("--lines", metavar="X", help="Of a sweep: draw --value over a parameter."),
    ] = None,
    by: Annotated[
        str | None,
        typer.Option("--by", metavar="NAME", help="Of --lines: a line for each value of this."),
    ] = None,
    value: Annotated[
        str | None,
        typer.Option("--value", metavar="LABEL", help="Of a sweep: the label to draw."),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at",
            metavar="NAME=VALUE",
            help="Of a sweep: only runs with this value of a parameter. Repeatable.",
        ),
    ] = None,
    quiet: QuietOption = False,
) -> None:
    """Draw trajectories over time, or the results of a sweep over its parameters.

    Several trajectories are drawn over each other. Needs somo-cli[plot].
    """
    target = output or f"{Path(paths[0]).stem}.png"
    kind = Path(target).suffix.removeprefix(".").lower()
    require(
        kind in ("png", "svg", "pdf"), "--output", f"{target} does not end with .png, .svg, .pdf"
    )
    refuse_unsafe(paths, [(target, "--output")])
    is_sweep = heat is not None or lines is not None
    require(not (heat and lines), "--lines", "it does not go with --heat")
    for option, given in (("--by", by), ("--value", value), ("--at", at)):
        require(is_sweep or not given, option, "it is for --heat or --lines")
    if is_sweep:
        require(len(paths) == 1, "--heat" if heat else "--lines", "it takes one table")
        require(value is not None, "--value", "the label to draw is missing")
        table = _sweep_table(paths[0], at or [])
        picture = _swept(table, heat, lines, str(value), by, kind)
    else:
        picture = _trajectories(paths, ys or [], x, kind)
    output_files.write_atomically(target, picture)
    if not quiet:
        terminal.print_message(f"{target}: {kind.upper()}")


def _trajectories(paths: list[str], ys: list[str], x: str, kind: str) -> bytes:
    from somo_cli.cli.tables import read_table_file
    from somo_cli.plot import names, trajectories

    tables = {path: read_table_file(path) for path in paths}
    shared = [
        name
        for name in next(iter(tables.values())).names
        if all(name in one.names for one in tables.values())
    ]
    try:
        names.matching(shared, [x])
        panels = (
            names.panels_by_unit(names.matching(shared, ys))
            if ys
            else names.standard_panels(shared)
        )
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--y' or '--x'") from None
    return trajectories.draw(_by_legend(tables), panels, x, kind)


def _by_legend(tables: "dict[str, Table]") -> "dict[str, Table]":
    """Return tables by the names of their files, or by their paths where these are alike."""
    stems = [Path(path).stem for path in tables]
    are_different = len(set(stems)) == len(stems)
    return dict(zip(stems if are_different else tables, tables.values(), strict=True))


def _sweep_table(path: str, at: list[str]) -> "SweepTable":
    from somo_cli.plot.sweep_table import read_sweep_table

    beside = Path(path).with_name("study.json")
    about = files.read_text(str(beside)) if beside.is_file() else None
    table = read_sweep_table(files.read_text(path), path, about)
    for text in at:
        name, equals, value = text.partition("=")
        require(equals == "=", "--at", f"{text!r} is not NAME=VALUE")
        try:
            table = table.where(name, value)
        except ValueError as error:
            raise typer.BadParameter(str(error), param_hint="'--at'") from None
    return table


def _swept(
    table: "SweepTable", heat: str | None, lines: str | None, value: str, by: str | None, kind: str
) -> bytes:
    from somo_cli.plot import sweeps

    try:
        if heat is None:
            return sweeps.draw_lines(table, str(lines), value, by, kind)
        first, comma, second = heat.partition(",")
        require(comma == ",", "--heat", f"{heat!r} is not X,Y")
        return sweeps.draw_heat(table, first, second, value, kind)
    except ValueError as error:
        option = "'--heat'" if heat else "'--lines'"
        raise typer.BadParameter(str(error), param_hint=option) from None
