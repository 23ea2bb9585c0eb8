"""Select columns by patterns of their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase


@dataclass(frozen=True, slots=True)
class ColumnSelection:
    """The selected columns of one kind: their names, and their indices among all of that kind."""

    names: tuple[str, ...]
    indices: tuple[int, ...]
    selects_all: bool


def select_columns(patterns: Sequence[str], names: Sequence[str]) -> ColumnSelection:
    """Return the columns whose name matches one of the patterns; without patterns, all columns.

    In a pattern `*` matches any text, dots included, `?` one character, and `[abc]` one of these
    characters. Upper and lower case differ.
    """
    indices = tuple(
        index
        for index, name in enumerate(names)
        if not patterns or any(fnmatchcase(name, pattern) for pattern in patterns)
    )
    return ColumnSelection(
        tuple(names[index] for index in indices), indices, len(indices) == len(names)
    )
