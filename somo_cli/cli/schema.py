"""somo schema: the JSON Schemas of our files."""

from typing import Annotated

import typer

from somo_cli.cli.application import (
    app,
    examples_of,
    report_errors,
    require,
)


@app.command(
    short_help="Print a JSON Schema, or list them.",
    epilog=examples_of("somo schema", "somo schema scene > scene.schema.json"),
)
@report_errors
def schema(
    name: Annotated[str | None, typer.Argument(help="Which one. [default: list them]")] = None,
) -> None:
    """Print a JSON Schema, which describes every field with its unit, or list the schemas."""
    from somo_cli.document.schemas import load_schema, schema_names, schema_text

    known = schema_names()
    if name is None:
        for one in known:
            typer.echo(f"{one:12}  {load_schema(one).get('description', '')}")
        return
    require(name in known, "NAME", f"there is no schema '{name}'; there are {', '.join(known)}")
    typer.echo(schema_text(name), nl=False)
