"""Compute the lowest and the highest point of shapes in the world."""

from __future__ import annotations

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose

MAX_RELATIVE_DEPTH = 1e-3
"""The largest overlap, divided by a body's length, that the engine resolves smoothly."""


def min_height(shape: Shape, link: Pose) -> float:
    """Return the lowest z [m] of a shape in the world, for a link with this pose in the world."""
    height, (x, y, z) = _height_and_up(shape, link)
    return height - shape.solid.reach((-x, -y, -z))


def max_height(shape: Shape, link: Pose) -> float:
    """Return the highest z [m] of a shape in the world, for a link with this pose in the world."""
    height, up = _height_and_up(shape, link)
    return height + shape.solid.reach(up)


def _height_and_up(shape: Shape, link: Pose) -> tuple[float, Vector]:
    """Return the height of a shape's origin [m], and the world's z axis in the shape's axes."""
    rotation = geometry.multiply(link.rotation, geometry.rotation_from_rpy(shape.rpy))
    return link.point(shape.position)[2], rotation[2]
