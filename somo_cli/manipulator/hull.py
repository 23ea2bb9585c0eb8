"""Convex hulls, which represent meshes in contact."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Position
from somo_cli.manipulator.geometry import Vector


@dataclass(frozen=True, slots=True)
class Hull:
    """A convex polyhedron in its frame; every face is a triangle, counterclockwise from outside."""

    vertices: tuple[Position, ...]
    faces: tuple[tuple[int, int, int], ...]

    @property
    def height(self) -> float:
        """The extent along z."""
        return self._extent(2)

    @property
    def smallest_extent(self) -> float:
        """The smallest of the extents along x, y and z."""
        return min(map(self._extent, range(3)))

    @property
    def circumradius(self) -> float:
        """The distance of the farthest vertex from the origin of the frame."""
        return max(map(geometry.norm, self.vertices))

    def reach(self, direction: Vector) -> float:
        """Return the farthest extent from the origin along a unit direction in its own axes."""
        x, y, z = direction
        return max(x * px + y * py + z * pz for px, py, pz in self.vertices)

    def _extent(self, axis: int) -> float:
        along = [vertex[axis] for vertex in self.vertices]
        return max(along) - min(along)
