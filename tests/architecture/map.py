"""Draw the rooms of the package and what each of them imports: `make map`.

Everything is read from the imports themselves, so the drawing cannot be out of date.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import NamedTuple

from tests.architecture.imports import SOURCES, imports, module_of
from tests.architecture.law import KNOWS, room_of

WIDTH = 96


class Room(NamedTuple):
    """A room as the imports show it."""

    files: int
    lines: int
    says: str  # the first line of its docstring
    knows: Mapping[str, int]  # rooms that it imports, and by how many imports


def rooms() -> dict[str, Room]:
    """Return every room in the order of the law, from the ground to the front door."""
    found: dict[str, Room] = {}
    for room in KNOWS:
        members = [name for name in SOURCES if room_of(name) == room]
        knows: dict[str, int] = {}
        for name in members:
            for target, _, _ in imports(SOURCES[name]):
                other = room_of(module_of(target)) if target.startswith("somo_cli") else room
                if other not in (room, ""):
                    knows[other] = knows.get(other, 0) + 1
        found[room] = Room(
            len(members),
            sum(SOURCES[name].count("\n") for name in members),
            _first_line(SOURCES.get(room, "")),
            knows,
        )
    return found


def circles(found: Mapping[str, Room]) -> list[tuple[str, ...]]:
    """Return every circle of rooms that know each other, as the path round it."""
    done: set[str] = set()
    seen: list[tuple[str, ...]] = []

    def follow(room: str, path: tuple[str, ...]) -> None:
        if room in path:
            seen.append((*path[path.index(room) :], room))
        elif room not in done:
            for other in found[room].knows if room in found else ():
                follow(other, (*path, room))
            done.add(room)

    for room in found:
        follow(room, ())
    return seen


def drawn(found: Mapping[str, Room]) -> str:
    """Return the drawing: rooms from the ground up, and after each the rooms that it imports."""
    order = [room for room in found if room]
    width = max(map(len, order)) + 2
    lines = []
    for room in order:
        row = f"{room:<{width}}"
        for other in order:
            if other not in found[room].knows:
                continue
            if len(row) + len(other) > WIDTH:
                lines.append(row.rstrip())
                row = " " * width
            row += f"{other}  "
        lines.append(row.rstrip())
    arrows = sum(len(one.knows) for one in found.values())
    lines.append(
        f"{len(order)} rooms, {arrows} arrows, {len(against(found))} against the stream, "
        f"{len(circles(found))} circles"
    )
    return "\n".join(lines)


def against(found: Mapping[str, Room]) -> list[tuple[str, str]]:
    """Return every arrow from a room to one that comes after it."""
    order = list(found)
    return [
        (room, other)
        for room, one in found.items()
        for other in one.knows
        if order.index(other) > order.index(room)
    ]


def sizes(found: Mapping[str, Room]) -> str:
    """Return files, lines and purpose of every room."""
    width = max(map(len, found))
    return "\n".join(
        f"{room:<{width}} {one.files:>4} files {one.lines:>6} lines  {one.says}"
        for room, one in found.items()
        if room
    )


def _first_line(source: str) -> str:
    text = ast.get_docstring(ast.parse(source)) if source else None
    return (text or "").partition("\n")[0]


if __name__ == "__main__":
    print(f"{sizes(rooms())}\n\neach room, and what it imports:\n\n{drawn(rooms())}")
