"""Find words in the pages of the manual."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from somo_cli.manual.topics import TOPICS, page


class Match(NamedTuple):
    """A line of a page, and the heading that it is under."""

    topic: str
    heading: str
    line: str


def matches(words: Sequence[str]) -> list[Match]:
    """Return the lines that have all the words, whatever their case, in the order of the topics."""
    wanted = [word.casefold() for word in words]
    return [
        match
        for topic in TOPICS
        for match in _lines(topic)
        if all(word in match.line.casefold() for word in wanted)
    ]


def _lines(topic: str) -> Iterator[Match]:
    heading, is_code = "", False
    for line in page(topic).splitlines():
        is_code ^= line.startswith("```")
        if line.startswith("#") and not is_code:
            heading = line.lstrip("# ")
        if line.strip():
            yield Match(topic, heading, line.strip())
