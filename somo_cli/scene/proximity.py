"""Find out without an engine whether bodies of a scene can overlap at the start."""

from __future__ import annotations

import math
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
    return _do_any_intersect(boxes)


def _do_any_intersect(boxes: Sequence[tuple[BoundingBox, bool]]) -> bool:
    """Return whether two boxes intersect that are not both of bodies with a prescribed pose.

    Only boxes that intersect along the axis on which the boxes lie farthest apart are compared.
    """
    solid = [one for one in boxes if not math.isnan(one[0][0][0])]
    if not solid:
        return False
    spreads = [
        max(box[axis][0] for box, _ in solid) - min(box[axis][0] for box, _ in solid)
        for axis in range(3)
    ]
    axis = spreads.index(max(spreads))
    near: list[tuple[BoundingBox, bool]] = []
    for box, is_prescribed in sorted(solid, key=lambda one: one[0][axis][0]):
        near = [one for one in near if one[0][axis][1] > box[axis][0]]
        if any(
            _boxes_intersect(box, other)
            for other, is_other_prescribed in near
            if not (is_prescribed and is_other_prescribed)
        ):
            return True
        near.append((box, is_prescribed))
    return False


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
