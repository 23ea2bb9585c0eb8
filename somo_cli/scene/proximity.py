"""Find out without an engine whether bodies of a scene can overlap at the start."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.geometry import Matrix
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.scene.extents import max_height, min_height
from somo_cli.scene.model import Scene
from somo_cli.scene.placement import with_heights

BoundingBox = tuple[tuple[float, float], ...]
"""The lowest and the highest coordinate [m] along x, y and z of the world frame."""

# rotations of the world that turn its x, its y and its z axis upwards
_AXIS_UP_ROTATIONS: tuple[Matrix, ...] = (
    ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    geometry.IDENTITY,
)


def can_overlap_at_start(scene: Scene) -> bool:
    """Return whether the bounding boxes of two bodies intersect, or one reaches into the ground.

    Pairs of bodies that both have a prescribed pose do not count.
    """
    boxes: list[tuple[BoundingBox, bool]] = []
    for one in scene.manipulators:
        boxes.append((bounding_box(one.compiled.chain, one.initial_angles, one.pose), False))
    for rigid_object in with_heights(scene.objects, scene.ground):
        if not rigid_object.collides:
            continue
        boxes.append(
            (
                bounding_box(rigid_object.chain, (), rigid_object.pose),
                rigid_object.has_prescribed_pose,
            )
        )
    ground = scene.ground
    if ground is not None and any(
        not has_prescribed_pose and box[2][0] < ground.height for box, has_prescribed_pose in boxes
    ):
        return True
    return any(
        _boxes_intersect(one, other)
        for (one, is_prescribed), (other, is_other_prescribed) in itertools.combinations(boxes, 2)
        if not (is_prescribed and is_other_prescribed)
    )


def bounding_box(chain: Chain, angles: Sequence[float], base: Pose) -> BoundingBox:
    """Return the bounding box of a chain at these joint angles [rad]; NaN if it has no shapes."""
    poses = link_poses(chain, angles, base)
    shapes = [
        (shape, pose)
        for link, pose in zip(chain.links, poses, strict=True)
        for shape in link.shapes
    ]
    found = []
    for rotation in _AXIS_UP_ROTATIONS:
        rotated = [(shape, _rotated(pose, rotation)) for shape, pose in shapes]
        found.append(
            (
                min((min_height(*one) for one in rotated), default=float("nan")),
                max((max_height(*one) for one in rotated), default=float("nan")),
            )
        )
    return tuple(found)


def _rotated(pose: Pose, rotation: Matrix) -> Pose:
    return Pose(
        geometry.rotate(rotation, pose.position), geometry.multiply(rotation, pose.rotation)
    )


def _boxes_intersect(one: BoundingBox, other: BoundingBox) -> bool:
    return all(
        low < other_high and other_low < high
        for (low, high), (other_low, other_high) in zip(one, other, strict=True)
    )
