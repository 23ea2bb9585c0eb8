"""Check that no manipulator starts inside the ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.extents import MAX_RELATIVE_DEPTH, min_height
from somo_cli.scene.reader import initial_angles_of


def ground_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], chain: Chain, is_sound: IsSound
) -> Iterator[Problem]:
    """Yield an error for the manipulator `data` at `at` if it starts inside the scene's ground.

    A base that is not free may start in the ground: the two do not collide.
    """
    scene: Any = document.data
    keys = ("position", "rpy", "base", "initial_angles")
    if "ground" not in scene or not is_sound(("ground",)):
        return
    if not all(is_sound((*at, key)) for key in keys):
        return
    motion = data.get("motion")
    if isinstance(motion, Mapping) and motion.get("frame") == "world":
        return  # a file says where it starts, and the engine finds what overlaps there
    angles = initial_angles_of(data.get("initial_angles", 0), chain)
    if len(angles) != len(chain.joints):
        return  # another check reports the wrong number of angles
    position, rpy = (geometry.vector(data.get(key, (0, 0, 0))) for key in ("position", "rpy"))
    height = float(scene["ground"].get("height", 0))
    poses = link_poses(chain, angles, Pose.of(position, rpy))
    first = 0 if data.get("base") == "free" else 1
    depths = {
        link.name: height - min(min_height(shape, pose) for shape in link.shapes)
        for link, pose in zip(chain.links[first:], poses[first:], strict=True)
        if link.shapes
    }
    if not depths:
        return
    name = max(depths, key=depths.__getitem__)
    if depths[name] > MAX_RELATIVE_DEPTH * chain.length:
        yield Problem(
            document.span((*at, "position")),
            f"link '{name}' starts {depths[name]:.3g} m inside the ground",
            "raise the manipulator with position, or lower the ground with its height",
        )
