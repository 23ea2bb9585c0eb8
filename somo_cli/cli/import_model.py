"""somo import: the definition of a model in MJCF, SDF or URDF."""

import os
from pathlib import Path
from typing import Annotated

import typer

from somo_cli import output_files, terminal
from somo_cli.cli.application import (
    QuietOption,
    app,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_unsafe

_MAX_BYTES = 20_000_000


@app.command(
    "import",
    short_help="Find the definition of a URDF, SDF or MJCF.",
    epilog=examples_of("somo import finger.urdf", "somo import hand.xml --body hand -o hand.yaml"),
)
@report_errors
def import_model(
    model: Annotated[str, typer.Argument(help="A URDF, an SDF or an MJCF, known by its root.")],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="The definition to write; - is standard output. [default: the model's name with "
            ".yaml, in the current directory, unless there is such a file]",
        ),
    ] = None,
    body: Annotated[
        str | None,
        typer.Option(
            "--body",
            metavar="NAME",
            help="The body of the world to take, for an MJCF of several. [default: the only one "
            "with hinges]",
        ),
    ] = None,
    quiet: QuietOption = False,
) -> None:
    """Find the definition of a chain with springs: segments of one shape in line, or limbs of such.

    The definition is compiled and compared with the model: masses, centres of mass, inertias,
    hinges, axes, springs, dampers and limits agree to 1e-9, or nothing is written.
    """
    from somo_cli import files
    from somo_cli.document.parse import parse
    from somo_cli.exchange.imported import import_model as imported_model
    from somo_cli.exchange.imported import require_same
    from somo_cli.manipulator.compile import compile_definition

    written = output or f"{Path(model).stem}.yaml"
    refuse_unsafe([model], [(written, "--output")])
    is_new = output is not None or not os.path.lexists(written)
    require(is_new, "--output", f"{written} exists: name it with -o to replace it")
    text = files.read_text(model, _MAX_BYTES)
    found = imported_model(text, model, body)
    definition = found.text(Path(model).name)
    document = parse(definition, f"definition of {model}")
    compiled = compile_definition(document)
    require_same(found, compiled.chain, model, text)
    if written == "-":
        with output_files.open_partial("-") as stream:
            stream.write(definition)
        return
    output_files.write_atomically(written, definition)
    terminal.print_problems(compiled.warnings, document.texts)
    if not quiet:
        scale = found.scale
        terminal.print_message(f"{written}: {compiled.described(scale)}")
