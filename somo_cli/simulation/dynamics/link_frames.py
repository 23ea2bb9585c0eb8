"""The frames of all links of a chain at a pose, as one array of homogeneous transforms."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics.cross_products import skew_matrices

IntArray: TypeAlias = npt.NDArray[np.intp]

_IDENTITY_TRANSFORM = np.eye(4)


class LinkFrames:
    """The transforms that do not depend on the pose; lengths in the units of the chain."""

    def __init__(self, chain: Chain) -> None:
        joints = chain.joints
        self._count = len(joints)
        self._frame_products = _frame_products(chain)
        # each joint as a homogeneous transform, linear in 1, sin q and 1 - cos q (Rodrigues)
        self._constant: Array = np.tile(np.eye(4), (self._count, 1, 1))
        self._constant[:, :3, 3] = np.array([joint.origin for joint in joints]).reshape(-1, 3)
        axes = np.array([joint.axis for joint in joints]).reshape(-1, 3)
        self._sine: Array = np.zeros((self._count, 4, 4))
        self._sine[:, :3, :3] = skew_matrices(axes)
        self._versine: Array = self._sine @ self._sine
        for index, joint in enumerate(joints):
            if joint.rpy != geometry.ZERO:
                turn = np.array(geometry.rotation_from_rpy(joint.rpy))
                self._constant[index, :3, :3] = turn
                self._sine[index, :3, :3] = turn @ self._sine[index, :3, :3]
                self._versine[index, :3, :3] = turn @ self._versine[index, :3, :3]

    def at(self, angles: Array, base: Pose) -> Array:
        """Return the homogeneous transforms of all link frames in the world, (n + 1, 4, 4)."""
        sine, versine = np.sin(angles), np.sin(0.5 * angles)
        versine *= 2 * versine
        frames: Array = np.empty((self._count + 1, 4, 4))
        frames[0] = _IDENTITY_TRANSFORM
        frames[0, :3, :3], frames[0, :3, 3] = base.rotation, base.position
        steps = frames[1:]
        np.multiply(sine[:, np.newaxis, np.newaxis], self._sine, steps)
        steps += self._constant
        steps += versine[:, np.newaxis, np.newaxis] * self._versine
        # products of 2, 4, 8, ... in a row (Hillis and Steele, Comm. ACM 29 (1986) 1170): calls
        # into numpy are what this costs
        for links, before in self._frame_products:
            frames[links] = frames[before] @ frames[links]
        return frames


def _frame_products(chain: Chain) -> tuple[tuple[slice | IntArray, slice | IntArray], ...]:
    """Return the rounds of products that turn frames in the parent into frames in the world.

    Each frame is multiplied by that of its parent, then by that 2, 4, ... links before. For a lone
    manipulator these are slices, which numpy takes without a copy.
    """
    if not chain.limbs:
        steps = tuple(1 << power for power in range(len(chain.joints).bit_length()))
        return tuple((slice(step, None), slice(None, -step)) for step in steps)
    found: list[tuple[IntArray, IntArray]] = []
    before = np.array([-1, *(joint.parent for joint in chain.joints)], dtype=np.intp)
    while (before >= 0).any():
        links = np.flatnonzero(before >= 0)
        found.append((links, before[links]))
        before[links] = before[before[links]]
    return tuple(found)
