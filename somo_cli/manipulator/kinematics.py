"""Where the links are: poses of all link frames from the base's pose and the joint angles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.geometry import Matrix, Vector

Frame: TypeAlias = tuple[Vector, Matrix]
"""Origin and axes, as in `Pose`."""


@dataclass(frozen=True, slots=True)
class Pose:
    """A frame in the world: where its origin is, and its axes as the columns of a rotation."""

    position: Vector = geometry.ZERO
    rotation: Matrix = geometry.IDENTITY

    def point(self, local: Vector) -> Vector:
        """Return the world coordinates of a point given in this frame."""
        return geometry.add(self.position, geometry.rotate(self.rotation, local))


def link_poses(chain: Chain, angles: Sequence[float], base: Pose) -> tuple[Pose, ...]:
    """Return the pose in the world of every link frame, root first.

    `angles` holds one angle [rad] per joint, in their order; `base` is the pose of the root's URDF
    frame. Positions are in the units of the chain.
    """
    frames = Kinematics(chain).frames(angles, (base.position, base.rotation))
    return tuple(Pose(*frame) for frame in frames)


class Kinematics:
    """The same for many poses of one chain: a recorded row may ask for it in every step."""

    def __init__(self, chain: Chain) -> None:
        self._joints = [
            (
                joint.parent,
                joint.origin,
                None if joint.rpy == geometry.ZERO else geometry.rotation_from_rpy(joint.rpy),
                joint.axis,
                _number_of_axis(joint.axis),
            )
            for joint in chain.joints
        ]

    def frames(self, angles: Sequence[float], base: Frame) -> list[Frame]:
        """Return origin and axes of every link frame in the world, root first."""
        frames = [base]
        for (parent, origin, turned, axis, number), angle in zip(self._joints, angles, strict=True):
            position, rotation = frames[parent]
            if origin != geometry.ZERO:
                position = _moved(position, rotation, origin)
            if number is not None and turned is None:
                rotation = _turned(rotation, number, angle)
            else:
                turn = geometry.rotation_about(axis, angle)
                turn = turn if turned is None else geometry.multiply(turned, turn)
                rotation = geometry.multiply(rotation, turn)
            frames.append((position, rotation))
        return frames


def _number_of_axis(axis: Vector) -> int | None:
    """Return which coordinate axis it is, None if it is none."""
    return axis.index(1.0) if sorted(axis) == [0.0, 0.0, 1.0] else None


def _moved(position: Vector, rotation: Matrix, local: Vector) -> Vector:
    px, py, pz = position
    (_, _, xz), (_, _, yz), (_, _, zz) = rotation
    x, y, z = local
    if x == y == 0.0:
        return (px + xz * z, py + yz * z, pz + zz * z)
    return geometry.add(position, geometry.rotate(rotation, local))


def _turned(rotation: Matrix, number: int, angle: float) -> Matrix:
    """Return rotation · turn about a coordinate axis, to the last digit `rotation_about`'s."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    cos, sin = math.cos(angle), math.sin(angle)
    one = cos + (1.0 - cos)  # is not always 1
    if number == 0:
        return (
            (a * one, b * cos + c * sin, c * cos - b * sin),
            (d * one, e * cos + f * sin, f * cos - e * sin),
            (g * one, h * cos + i * sin, i * cos - h * sin),
        )
    if number == 1:
        return (
            (a * cos - c * sin, b * one, a * sin + c * cos),
            (d * cos - f * sin, e * one, d * sin + f * cos),
            (g * cos - i * sin, h * one, g * sin + i * cos),
        )
    return (
        (a * cos + b * sin, b * cos - a * sin, c * one),
        (d * cos + e * sin, e * cos - d * sin, f * one),
        (g * cos + h * sin, h * cos - g * sin, i * one),
    )
