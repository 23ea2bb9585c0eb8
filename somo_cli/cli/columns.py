"""somo columns: what a scene can record."""

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from somo_cli.cli.application import (
    OutsideOption,
    PackageOption,
    SetOption,
    access_of,
    app,
    examples_of,
    report_errors,
)

if TYPE_CHECKING:
    from somo_cli.scene.available_columns import AvailableColumns


@app.command(
    short_help="List what a scene can record.",
    epilog=examples_of("somo columns scene.yaml", "somo columns scene.yaml --json"),
)
@report_errors
def columns(
    scene: Annotated[str, typer.Argument(help="A scene, or a definition to run by itself.")],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print every name, as JSON on standard output.")
    ] = False,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
) -> None:
    """List what a scene can record: quantities, units, how many columns, and which it records."""
    from somo_cli import loading
    from somo_cli.scene.available_columns import available_columns

    document = loading.load(scene, sets or [], *access_of(allow_outside, package))
    found = available_columns(loading.scene_of(document)[0])
    if as_json:
        typer.echo(json.dumps([_plain(one) for one in found], indent=2))
        return
    from somo_cli.analysis.text_table import table_lines

    head = ["quantity", "of", "columns", "recorded", "unit", "such as"]
    rows = [_cells(one) for one in found]
    for line in table_lines([head, *rows]):
        typer.echo(line)
    typer.echo("\na scene names quantities of manipulators in record.columns, of objects in")
    typer.echo("record.objects, or single columns by patterns in record.only")


def _cells(one: "AvailableColumns") -> list[str]:
    recorded = "all" if one.recorded == len(one.names) else str(one.recorded or "-")
    units = ", ".join(one.units)
    return [one.quantity, one.owner, str(len(one.names)), recorded, units, one.names[0]]


def _plain(one: "AvailableColumns") -> dict[str, Any]:
    return {
        "owner": one.owner,
        "quantity": one.quantity,
        "key": one.key,
        "units": list(one.units),
        "recorded": one.recorded,
        "names": list(one.names),
    }
