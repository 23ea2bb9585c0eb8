"""somo help: the manual."""

from typing import Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import (
    app,
    examples_of,
    report_errors,
)

_MOST_MATCHES = 20  # lines of one page


@app.command(
    name="help",
    short_help="Show the manual, or search it.",
    epilog=examples_of("somo help tour", "somo help contact stiffness"),
)
@report_errors
def show_help(
    words: Annotated[
        list[str] | None,
        typer.Argument(metavar="TOPIC|WORD", help="A topic, or words to look for."),
    ] = None,
) -> None:
    """Show a page of the manual, list its topics, or search it."""
    from somo_cli.manual import topics

    if not words:
        terminal.show_page(topics.contents())
    elif len(words) == 1 and words[0].lower() in topics.TOPICS:
        terminal.show_page(topics.page(words[0].lower()))
    else:
        _search(words)


def _search(words: list[str]) -> None:
    from somo_cli.manual.search import matches
    from somo_cli.manual.topics import TOPICS

    found = matches(words)
    if not found:
        raise typer.BadParameter(
            f"no page of the manual has '{' '.join(words)}'; the topics are {', '.join(TOPICS)}"
        )
    for topic in dict.fromkeys(match.topic for match in found):
        of_topic = [match for match in found if match.topic == topic]
        typer.echo(f"somo help {topic}")
        for match in of_topic[:_MOST_MATCHES]:
            typer.echo(f"  {match.heading}: {match.line}")
        if len(of_topic) > _MOST_MATCHES:
            typer.echo(f"  and {len(of_topic) - _MOST_MATCHES} lines more")
