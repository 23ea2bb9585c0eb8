"""somo check: what is wrong with files, without an engine."""

import json
from typing import Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.door import EXIT_CODES, app, ending
from somo_cli.problems import InvalidFile, Problem, has_errors, in_reading_order


@app.command(epilog=EXIT_CODES)
@ending
def check(
    paths: Annotated[list[str], typer.Argument(metavar="FILE...", help="Definitions, scenes.")],
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the findings as JSON on standard output.")
    ] = False,
) -> None:
    """Say everything that build and run would complain about, without an engine."""
    from somo_cli import loading

    found: list[Problem] = []
    texts: dict[str, str] = {}
    is_unreadable = False
    for path in paths:
        try:
            document = loading.load(path)
        except InvalidFile as error:
            found.extend(error.problems)
            texts.update(error.texts)
        except OSError as error:
            is_unreadable = True
            terminal.say(f"somo: {error.filename or path}: {error.strerror or error}")
        else:
            found.extend(loading.judged(document))
            texts.update(document.texts)
    found = list(in_reading_order(found, texts))
    if as_json:
        typer.echo(json.dumps([_plain(problem) for problem in found], indent=2))
    else:
        terminal.say_problems(found, texts)
    raise typer.Exit(5 if is_unreadable else int(has_errors(found)))


def _plain(problem: Problem) -> dict[str, object]:
    span = problem.span
    return {
        "path": span.source,
        "line": span.line,
        "column": span.column,
        "severity": problem.severity,
        "message": problem.message,
        "hint": problem.hint,
    }
