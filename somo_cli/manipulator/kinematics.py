"""Forward kinematics: poses of all link frames from the base pose and the joint angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.geometry import Matrix, Vector


@dataclass(frozen=True, slots=True)
class Pose:
    """A frame in the world: the position of its origin, and its axes as the columns of a matrix."""

    position: Vector = geometry.ZERO
    rotation: Matrix = geometry.IDENTITY

    @staticmethod
    def of(position: Vector, rpy: Vector) -> Pose:
        """Return the pose with this origin and URDF's roll, pitch, yaw [rad]."""
        return Pose(position, geometry.rotation_from_rpy(rpy))

    def point(self, local: Vector) -> Vector:
        """Return the world coordinates of a point given in this frame."""
        return geometry.add(self.position, geometry.rotate(self.rotation, local))

    def compose(self, local: Pose) -> Pose:
        """Return the world pose of a frame whose pose is given in this frame."""
        rotation = geometry.multiply(self.rotation, local.rotation)
        return Pose(self.point(local.position), rotation)


def max_distances(chain: Chain) -> list[float]:
    """Return the largest distance of each link frame's origin from the base frame's, root first.

    It is the length of the straightened chain, in its unit; joint limits are not considered.
    """
    found = [0.0]
    for joint in chain.joints:
        found.append(found[joint.parent] + geometry.norm(joint.origin))
    return found


def reach_of(chain: Chain) -> float:
    """Return how far from the origin of its base frame a chain can reach, in its unit.

    That is the straightened length, and for limbs where they are mounted.
    """
    mounts = (geometry.norm(one.origin) for one in chain.joints if one.parent == 0)
    return chain.length + (max(mounts) if chain.limbs else 0.0)


def link_poses(chain: Chain, angles: Sequence[float], base: Pose) -> tuple[Pose, ...]:
    """Return the pose in the world of every link frame, root first.

    `angles` has the angle [rad] of each joint; `base` is the pose of the root's URDF frame.
    Positions are in the units of the chain.
    """
    poses = [base]
    for joint, angle in zip(chain.joints, angles, strict=True):
        parent = poses[joint.parent]
        rotation = geometry.multiply(
            parent.rotation,
            geometry.multiply(
                geometry.rotation_from_rpy(joint.rpy), geometry.rotation_about(joint.axis, angle)
            ),
        )
        poses.append(Pose(parent.point(joint.origin), rotation))
    return tuple(poses)
