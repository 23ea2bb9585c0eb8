"""somo examples: copy the shipped definitions."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from somo_cli import files, terminal
from somo_cli.cli.application import (
    QuietOption,
    app,
    examples_of,
    report_errors,
)


@app.command(
    short_help="Copy the shipped definitions, scenes and schemas.",
    epilog=examples_of("somo examples", "somo examples first-tries"),
)
@report_errors
def examples(
    folder: Annotated[str, typer.Argument(help="The folder to create.")] = "somo-examples",
    quiet: QuietOption = False,
) -> None:
    """Copy the shipped definitions, scenes and schemas into a new folder.

    It prints the copied files, and on standard error what to type next.
    """
    for path in files.copy_examples(folder):
        typer.echo(path)
    if not quiet:
        terminal.print_lines(["next:", *(f"  {line}" for line in _next_commands(folder))])


def _next_commands(folder: str) -> list[str]:
    """Return commands that work on the copies, as a shell needs them."""
    scene = shlex.quote(str(Path(folder, "definitions", "scene.yaml")))
    study = shlex.quote(str(Path(folder, "definitions", "grasp_study.yaml")))
    return [
        f"somo show {scene}",
        f"somo run {scene} --duration 2 -o finger.csv",
        "somo render finger.csv",
        f"somo render {scene} --at 1 -o finger.png",
        f"somo sweep {study} --dry-run",
        "somo help tour",
    ]
