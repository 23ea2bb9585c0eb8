"""Which columns of those at hand a plan keeps, by patterns of their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase


@dataclass(frozen=True, slots=True)
class Kept:
    """Columns of one kind that are kept: their names, and their places among those at hand."""

    names: tuple[str, ...]
    places: tuple[int, ...]
    is_whole: bool


def kept(patterns: Sequence[str], names: Sequence[str]) -> Kept:
    """Return the columns whose name matches one of the patterns; without patterns, all.

    In a pattern `*` stands for anything, points included, `?` for one character, and `[abc]` for
    one of these; capitals count.
    """
    places = tuple(
        place
        for place, name in enumerate(names)
        if not patterns or any(fnmatchcase(name, pattern) for pattern in patterns)
    )
    return Kept(tuple(names[place] for place in places), places, len(places) == len(names))
