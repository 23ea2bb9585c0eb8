"""A file at a glance: a tree of entries, each a name with facts, as text or as plain values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

Fact: TypeAlias = float | int | str | Sequence[float]


@dataclass(frozen=True, slots=True)
class Entry:
    """One part: its name, its facts by name, and its own parts.

    The name of a fact ends with its unit, such as mass_kg; `text` says the facts in words.
    """

    name: str
    text: str
    facts: Mapping[str, Fact]
    parts: Sequence[Entry] = ()

    def plain(self) -> dict[str, Any]:
        """Return the entry as plain values, for JSON."""
        found: dict[str, Any] = {"name": self.name, **self.facts}
        if self.parts:
            found["parts"] = [part.plain() for part in self.parts]
        return found


def tree_lines(entry: Entry) -> Iterator[str]:
    """Yield the lines of an entry and of its parts, as a tree."""
    yield _line(entry)
    yield from _branches(entry.parts, "")


def _branches(parts: Sequence[Entry], indent: str) -> Iterator[str]:
    for index, part in enumerate(parts):
        is_last = index == len(parts) - 1
        yield f"{indent}{'└─ ' if is_last else '├─ '}{_line(part)}"
        yield from _branches(part.parts, indent + ("   " if is_last else "│  "))


def _line(entry: Entry) -> str:
    return f"{entry.name}: {entry.text}" if entry.text else entry.name
