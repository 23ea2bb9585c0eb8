"""A convex hull: what the engine touches of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.manipulator.dimensions import Position


@dataclass(frozen=True, slots=True)
class Hull:
    """A convex polyhedron in its frame; every face is a triangle, counterclockwise from outside."""

    vertices: tuple[Position, ...]
    faces: tuple[tuple[int, int, int], ...]


def height(hull: Hull) -> float:
    """Return the extent along z."""
    heights = [z for _, _, z in hull.vertices]
    return max(heights) - min(heights)
