"""somo show: a file at a glance."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import files
from somo_cli.cli.application import (
    OutsideOption,
    PackageOption,
    SetOption,
    access_of,
    app,
    examples_of,
    report_errors,
    require,
)

if TYPE_CHECKING:
    from somo_cli.analysis.overview import Entry


@app.command(
    short_help="Show a definition, a scene or a URDF as a tree.",
    epilog=examples_of("somo show finger.yaml", "somo show scene.yaml --json"),
)
@report_errors
def show(
    path: Annotated[str, typer.Argument(metavar="FILE", help="A definition, a scene or a URDF.")],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print it as JSON on standard output.")
    ] = False,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
) -> None:
    """Show a definition, a scene or a URDF as a tree.

    It has masses, stiffnesses, the slowest modes, and what drives what; of a URDF its joints.
    """
    from somo_cli import loading
    from somo_cli.analysis.manipulator_overview import manipulator_overview
    from somo_cli.analysis.scene_overview import scene_overview
    from somo_cli.analysis.urdf_overview import urdf_overview
    from somo_cli.scene.model import is_scene

    if path.lower().endswith(".urdf"):
        require(not sets, "--set", "it is for a definition or a scene")
        _print(urdf_overview(files.read_text(path), path), as_json)
        return
    document = loading.load(path, sets or [], *access_of(allow_outside, package))
    scene, _ = loading.scene_of(document)
    if is_scene(document):
        entry = scene_overview(Path(path).name, scene)
    else:
        (only,) = scene.manipulators
        entry = manipulator_overview(only.name, only.compiled.chain)
    _print(entry, as_json)


def _print(entry: "Entry", as_json: bool) -> None:
    from somo_cli.analysis.overview import tree_lines

    if as_json:
        typer.echo(json.dumps(entry.plain(), indent=2, ensure_ascii=False))
    else:
        typer.echo("\n".join(tree_lines(entry)))
