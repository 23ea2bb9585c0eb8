"""Which columns of those at hand a plan keeps, by patterns of their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase


@dataclass(frozen=True, slots=True)
class ColumnSelection:
    """Columns of one kind that are selected: their names, and their indices among those at hand."""

    names: tuple[str, ...]
    indices: tuple[int, ...]
    selects_all: bool


def select_columns(patterns: Sequence[str], names: Sequence[str]) -> ColumnSelection:
    """Return the columns whose name matches one of the patterns; without patterns, all.

    In a pattern `*` stands for anything, points included, `?` for one character, and `[abc]` for
    one of these; capitals count.
    """
    indices = tuple(
        index
        for index, name in enumerate(names)
        if not patterns or any(fnmatchcase(name, pattern) for pattern in patterns)
    )
    return ColumnSelection(
        tuple(names[index] for index in indices), indices, len(indices) == len(names)
    )
