"""Faults of a scene with a ground: what starts in it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain, Shape
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.manipulator.meaning import IsSound
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import Box, Cylinder
from somo_cli.problems import Pointer, Problem
from somo_cli.simulation.scene import per_joint

DEEPEST = 1e-3  # of the length: what the engine pushes out without a jerk


def faults(
    document: Document, at: Pointer, data: Mapping[str, Any], chain: Chain, is_sound: IsSound
) -> Iterator[Problem]:
    """Yield an error for the manipulator `data` at `at` if it starts inside the scene's ground.

    A base that is held may stand in the ground, with which it cannot collide.
    """
    scene: Any = document.data
    keys = ("position", "rpy", "base", "initial_angles")
    if "ground" not in scene or not is_sound(("ground",)):
        return
    if not all(is_sound((*at, key)) for key in keys):
        return
    angles = per_joint(data.get("initial_angles", 0), len(chain.joints))
    if len(angles) != len(chain.joints):
        return  # told where the start is judged
    rotation = geometry.rotation_from_rpy(tuple(data.get("rpy", geometry.ZERO)))
    base = Pose(tuple(data.get("position", geometry.ZERO)), rotation)
    height = float(scene["ground"].get("height", 0))
    poses = link_poses(chain, angles, base)
    first = 0 if data.get("base") == "free" else 1
    depths = {
        link.name: height - min(lowest(shape, pose) for shape in link.shapes)
        for link, pose in zip(chain.links[first:], poses[first:], strict=True)
        if link.shapes
    }
    if not depths:
        return
    name = max(depths, key=depths.__getitem__)
    if depths[name] > DEEPEST * chain.length:
        yield Problem(
            document.span((*at, "position")),
            f"link '{name}' starts {depths[name]:.3g} m inside the ground",
            "raise the manipulator with position, or lower the ground with its height",
        )


def lowest(shape: Shape, link: Pose) -> float:
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


def highest(shape: Shape, link: Pose) -> float:
    """Return the greatest height of a shape of a link at a pose [m].

    Turned upside down about the world's x axis, which keeps a rotation one, it is the lowest.
    """
    (x, y, z), (first, second, third) = link.position, link.rotation
    turned = (first, _opposite(second), _opposite(third))
    return -lowest(shape, Pose((x, -y, -z), turned))


def _opposite(a: geometry.Vector) -> geometry.Vector:
    return (-a[0], -a[1], -a[2])
