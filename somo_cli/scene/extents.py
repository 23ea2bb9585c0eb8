"""How high and how low the shapes of a link reach."""

from __future__ import annotations

import math

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import Box, Cylinder

MAX_RELATIVE_DEPTH = 1e-3  # of the length: what the engine pushes out without a jerk


def min_height(shape: Shape, link: Pose) -> float:
    """Return the lowest height of a shape of a link at a pose [m]."""
    own = geometry.multiply(link.rotation, geometry.rotation_from_rpy(shape.rpy))
    x, y, z = own[2]  # how far up each of the shape's axes points
    solid = shape.solid
    if isinstance(solid, Box):
        reach = sum(abs(up) * edge / 2 for up, edge in zip((x, y, z), solid.size, strict=True))
    elif isinstance(solid, Cylinder):
        reach = abs(z) * solid.length / 2 + math.hypot(x, y) * solid.radius
    elif isinstance(solid, Capsule):
        reach = abs(z) * solid.length / 2 + solid.radius
    elif isinstance(solid, RoundedBox):
        reach = sum(abs(up) * half for up, half in zip((x, y, z), solid.core, strict=True))
        reach += solid.radius
    elif isinstance(solid, Hull):
        reach = -min(x * px + y * py + z * pz for px, py, pz in solid.vertices)
    else:
        reach = solid.radius
    return link.point(shape.position)[2] - reach


def max_height(shape: Shape, link: Pose) -> float:
    """Return the greatest height of a shape of a link at a pose [m].

    Turned upside down about the world's x axis, which keeps a rotation one, it is the lowest.
    """
    (x, y, z), (first, second, third) = link.position, link.rotation
    turned = (first, _opposite(second), _opposite(third))
    return -min_height(shape, Pose((x, -y, -z), turned))


def _opposite(a: geometry.Vector) -> geometry.Vector:
    return (-a[0], -a[1], -a[2])
