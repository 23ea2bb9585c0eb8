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
                joint.axis,
                _number_of_axis(joint.axis) if joint.rpy == geometry.ZERO else None,
                geometry.rotation_from_rpy(joint.rpy),
            )
            for joint in chain.joints
        ]

    def frames(self, angles: Sequence[float], base: Frame) -> list[Frame]:
        """Return origin and axes of every link frame in the world, root first.

        Most joints turn about the x or y axis of their link, which is written out without its
        products with zero: a call for each would take as long as what it does.
        """
        frames = [base]
        cosine, sine = math.cos, math.sin
        for (parent, origin, axis, number, turned), angle in zip(self._joints, angles, strict=True):
            position, rotation = frames[parent]
            (a, b, c), (d, e, f), (g, h, i) = rotation
            px, py, pz = position
            x, y, z = origin
            px += a * x + b * y + c * z
            py += d * x + e * y + f * z
            pz += g * x + h * y + i * z
            cos, sin = cosine(angle), sine(angle)
            one = cos + (1.0 - cos)  # as in `rotation_about`, and not always 1
            if number == 0:
                rotation = (
                    (a * one, b * cos + c * sin, c * cos - b * sin),
                    (d * one, e * cos + f * sin, f * cos - e * sin),
                    (g * one, h * cos + i * sin, i * cos - h * sin),
                )
            elif number == 1:
                rotation = (
                    (a * cos - c * sin, b * one, a * sin + c * cos),
                    (d * cos - f * sin, e * one, d * sin + f * cos),
                    (g * cos - i * sin, h * one, g * sin + i * cos),
                )
            else:
                turn = geometry.multiply(turned, geometry.rotation_about(axis, angle))
                rotation = geometry.multiply(rotation, turn)
            frames.append(((px, py, pz), rotation))
        return frames


def _number_of_axis(axis: Vector) -> int | None:
    """Return which coordinate axis it is, None if it is none."""
    return axis.index(1.0) if sorted(axis) == [0.0, 0.0, 1.0] else None
