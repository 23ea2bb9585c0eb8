"""Whether anything in a scene can be in anything else at the start, told without an engine."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.geometry import Matrix
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.simulation.extents import highest, lowest
from somo_cli.simulation.placing import placed
from somo_cli.simulation.scene import Scene

Extent = tuple[tuple[float, float], ...]
"""The lowest and the highest coordinate [m] along x, y and z of the world."""

# the world turned so that its x, its y and its z axis points upwards
_UPWARDS: tuple[Matrix, ...] = (
    ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
    ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    geometry.IDENTITY,
)


def is_crowded(scene: Scene) -> bool:
    """Whether boxes around two parts of a scene meet, or one around a part and the ground."""
    boxes: list[tuple[Extent, bool]] = []
    for one in scene.manipulators:
        start = Pose(one.position, geometry.rotation_from_rpy(one.rpy))
        boxes.append((extent(one.compiled.chain, one.initial_angles, start), False))
    for thing in placed(scene.things, scene.ground):
        start = Pose(thing.position, geometry.rotation_from_rpy(thing.rpy))
        boxes.append((extent(thing.chain, (), start), thing.is_held))
    ground = scene.ground
    if ground is not None and any(
        not is_held and box[2][0] < ground.height for box, is_held in boxes
    ):
        return True
    return any(
        _meet(one, other)
        for (one, is_held), (other, is_other_held) in itertools.combinations(boxes, 2)
        if not (is_held and is_other_held)
    )


def extent(chain: Chain, angles: Sequence[float], base: Pose) -> Extent:
    """Return the box around a chain at these joint angles [rad]; not a number without shapes."""
    poses = link_poses(chain, angles, base)
    shapes = [
        (shape, pose)
        for link, pose in zip(chain.links, poses, strict=True)
        for shape in link.shapes
    ]
    found = []
    for turn in _UPWARDS:
        turned = [(shape, _turned(pose, turn)) for shape, pose in shapes]
        found.append(
            (
                min((lowest(*one) for one in turned), default=float("nan")),
                max((highest(*one) for one in turned), default=float("nan")),
            )
        )
    return tuple(found)


def _turned(pose: Pose, turn: Matrix) -> Pose:
    return Pose(geometry.rotate(turn, pose.position), geometry.multiply(turn, pose.rotation))


def _meet(one: Extent, other: Extent) -> bool:
    return all(
        low < other_high and other_low < high
        for (low, high), (other_low, other_high) in zip(one, other, strict=True)
    )
