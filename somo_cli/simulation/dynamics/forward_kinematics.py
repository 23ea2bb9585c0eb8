"""The link frames of a chain at many instants at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose

Frames: TypeAlias = tuple[Array, Array]
"""Origins, shape (..., 3, instants), and axes as the columns of (..., 3, 3, instants)."""


class ForwardKinematics:
    """The arrays of a chain that do not depend on its pose; `frames` gives all link frames.

    Every operation is on all instants together, and no number depends on its neighbours. So a frame
    is the same to the last bit whichever others are computed with it.
    """

    def __init__(self, chain: Chain) -> None:
        self._count = len(chain.links)
        self._joints = [
            (
                joint.parent,
                [(axis, offset) for axis, offset in enumerate(joint.origin) if offset != 0],
                None
                if joint.rpy == geometry.ZERO
                else np.array(geometry.rotation_from_rpy(joint.rpy)),
                joint.axis,
            )
            for joint in chain.joints
        ]

    def frames(self, angles: Array, base: Frames) -> Frames:
        """Return every link frame in the world, root first: (links, 3, m) and (links, 3, 3, m).

        `angles` has the shape (n, m), for m instants; those of the base may be m, or one for all.
        """
        instants = angles.shape[1]
        positions: Array = np.empty((self._count, 3, instants))
        rotations: Array = np.empty((self._count, 3, 3, instants))
        positions[0], rotations[0] = base
        sines, cosines = np.sin(angles), np.cos(angles)
        for joint, (parent, offsets, turned, axis) in enumerate(self._joints):
            rotation = rotations[parent]
            positions[joint + 1] = positions[parent]
            for along, offset in offsets:
                positions[joint + 1] += offset * rotation[:, along]
            if turned is not None:
                rotation = _product(rotation, turned)
            _write_rotated(rotation, axis, sines[joint], cosines[joint], rotations[joint + 1])
        return positions, rotations


def _write_rotated(
    rotation: Array, axis: geometry.Vector, sine: Array, cosine: Array, out: Array
) -> None:
    """Write a rotation followed by one about an axis of its own, shapes (3, 3, m) and (m,)."""
    if sorted(axis) == [0.0, 0.0, 1.0]:
        # most joints, written out without products with zero: two columns turn in their plane
        fixed = axis.index(1.0)
        first, second = (fixed + 1) % 3, (fixed + 2) % 3
        out[:, fixed] = rotation[:, fixed]
        out[:, first] = rotation[:, first] * cosine + rotation[:, second] * sine
        out[:, second] = rotation[:, second] * cosine - rotation[:, first] * sine
        return
    # Rodrigues: 1 + sin(q) K + (1 - cos(q)) K², with K v = axis x v
    cross: Array = np.cross(axis, np.eye(3)).T
    out[:] = rotation + sine * _product(rotation, cross)
    out += (1 - cosine) * _product(rotation, cross @ cross)


def _product(rotation: Array, matrix: Array) -> Array:
    """Return rotations, shape (3, 3, m), times one matrix, shape (3, 3)."""
    columns = np.moveaxis(rotation, 1, 0)
    return np.stack(
        [sum(along * matrix[j, k] for j, along in enumerate(columns)) for k in range(3)], axis=1
    )


def frames_from_poses(poses: Sequence[Pose]) -> Frames:
    """Return poses as arrays of shape (3, m) and (3, 3, m)."""
    positions: Array = np.array([pose.position for pose in poses]).T
    rotations: Array = np.array([pose.rotation for pose in poses])
    return positions, np.moveaxis(rotations, 0, -1)


def point_positions(frames: Frames, link: int, local: geometry.Vector) -> Array:
    """Return the world positions, shape (3, m), of a point given in the frame of its link."""
    positions, rotations = frames
    place: Array = positions[link].copy()
    for along, offset in enumerate(local):
        place += offset * rotations[link][:, along]
    return place


def quaternions(rotations: Array) -> Array:
    """Return rotations, shape (..., 3, 3, m), as unit quaternions (x, y, z, w), (..., 4, m).

    As `geometry.quaternion_from_rotation`: w >= 0, without division by small numbers.
    """
    r = np.moveaxis(rotations, (-3, -2), (0, 1))
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    largest = np.argmax([r[0, 0], r[1, 1], r[2, 2], trace], axis=0)
    x, y, z = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    xy, yz, zx = r[0, 1] + r[1, 0], r[1, 2] + r[2, 1], r[2, 0] + r[0, 2]
    candidates: Array = np.array(
        [
            [1 + r[0, 0] - r[1, 1] - r[2, 2], xy, zx, x],
            [xy, 1 + r[1, 1] - r[2, 2] - r[0, 0], yz, y],
            [zx, yz, 1 + r[2, 2] - r[0, 0] - r[1, 1], z],
            [x, y, z, 1 + trace],
        ]
    )
    q = np.take_along_axis(candidates, largest[np.newaxis, np.newaxis], axis=0)[0]
    q /= np.copysign(np.sqrt(np.sum(q * q, axis=0)), q[3])
    return np.moveaxis(q, 0, -2)
