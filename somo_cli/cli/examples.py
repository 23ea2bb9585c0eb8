"""somo examples: copy the shipped definitions."""

from typing import Annotated

import typer

from somo_cli import files
from somo_cli.cli.application import EXIT_CODES, app, report_errors


@app.command(short_help="Copy the shipped definitions, scenes and schemas.", epilog=EXIT_CODES)
@report_errors
def examples(
    folder: Annotated[str, typer.Argument(help="The folder to create.")] = "somo-examples",
) -> None:
    """Copy the shipped definitions, scenes and schemas into a new folder."""
    for path in files.copy_examples(folder):
        typer.echo(path)
