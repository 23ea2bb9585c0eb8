"""somo show: a file at a glance."""

import json
from pathlib import Path
from typing import Annotated

import typer

from somo_cli.cli.application import (
    EXIT_CODES,
    OutsideOption,
    PackageOption,
    SetOption,
    access_of,
    app,
    report_errors,
)


@app.command(short_help="Show a definition or a scene as a tree.", epilog=EXIT_CODES)
@report_errors
def show(
    path: Annotated[str, typer.Argument(metavar="FILE", help="A definition or a scene.")],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print it as JSON on standard output.")
    ] = False,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
) -> None:
    """Show a definition or a scene as a tree: masses, stiffnesses, modes, what drives what.

    For example: somo show finger.yaml
    """
    from somo_cli import loading
    from somo_cli.analysis.manipulator_overview import manipulator_overview
    from somo_cli.analysis.overview import tree_lines
    from somo_cli.analysis.scene_overview import scene_overview
    from somo_cli.scene.model import is_scene

    document = loading.load(path, sets or [], *access_of(allow_outside, package))
    scene, _ = loading.scene_of(document)
    if is_scene(document):
        entry = scene_overview(Path(path).name, scene)
    else:
        (only,) = scene.manipulators
        entry = manipulator_overview(only.name, only.compiled.chain)
    if as_json:
        typer.echo(json.dumps(entry.plain(), indent=2, ensure_ascii=False))
    else:
        typer.echo("\n".join(tree_lines(entry)))
