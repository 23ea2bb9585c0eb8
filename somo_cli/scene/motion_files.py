"""Put the text of a CSV of poses in place of the path that the motion of a scene gives."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from somo_cli.document.include import include
from somo_cli.document.parse import Document
from somo_cli.problems import Problem, Span

MAX_MOTION_BYTES = 100_000_000  # bytes

FILE_POINTERS: tuple[tuple[str, ...], ...] = (
    ("manipulators", "*", "motion", "file"),
    ("objects", "*", "motion", "file"),
)
"""Where a motion may name a file instead of holding its text."""


def include_motion_files(
    document: Document, open_text: Callable[..., tuple[str, str]]
) -> tuple[Document, tuple[Problem, ...]]:
    """Put a mapping of source and text in place of every path; return the errors as well.

    `open_text` is `files.open_reference`.
    """
    return include(document, FILE_POINTERS, partial(open_text, largest=MAX_MOTION_BYTES), _poses)


def _poses(text: str, source: str, naming: Span) -> Document:
    return Document(
        source, {"source": source, "text": text}, {source: text}, {(): (naming, naming)}
    )
