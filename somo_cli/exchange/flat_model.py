"""A model as a tree of links, everything in the axes of its root with all joints at zero.

Frames of links differ between formats and tools; masses, hinges and axes in one frame do not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from somo_cli.exchange.precise_rpy import precise_rpy
from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Chain, Shape
from somo_cli.manipulator.dimensions import Dimension, Scale, scaled
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.manipulator.solids import Inertial


@dataclass(frozen=True, slots=True)
class FlatJoint:
    """A revolute joint: its hinge and its axis in the root's frame, its limits and its spring.

    A joint without limits has lower > upper. `group` numbers the joints that one control drives, -1
    where the file does not say. Units are those of the file.
    """

    name: str
    parent: int
    hinge: Vector
    axis: Vector
    lower: float = 0.0
    upper: float = -1.0
    effort: float = 0.0
    velocity: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    neutral_position: float = 0.0
    friction: float = 0.0
    group: int = -1

    @property
    def is_limited(self) -> bool:
        """Whether the joint has limits."""
        return self.lower <= self.upper


@dataclass(frozen=True, slots=True)
class FlatLink:
    """A rigid body: its pose, and mass properties and shapes in the root's frame."""

    name: str
    pose: Pose
    inertial: Inertial
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True)
class FlatModel:
    """Links, parents first; joint i moves link i + 1."""

    name: str
    links: tuple[FlatLink, ...]
    joints: tuple[FlatJoint, ...]

    @property
    def size(self) -> float:
        """The largest distance of a hinge or a centre of mass from the root, for tolerances."""
        points = [joint.hinge for joint in self.joints]
        points += [link.inertial.centre for link in self.links]
        return max(map(geometry.norm, points))

    def seen_from(self, frame: Pose) -> FlatModel:
        """Return the model in another frame, given in the root's."""
        turn = geometry.transposed(frame.rotation)

        def place(point: Vector) -> Vector:
            return geometry.rotate(turn, geometry.subtract(point, frame.position))

        links = tuple(
            FlatLink(
                link.name,
                Pose(place(link.pose.position), geometry.multiply(turn, link.pose.rotation)),
                Inertial(
                    link.inertial.mass,
                    place(link.inertial.centre),
                    geometry.rotated_tensor(link.inertial.inertia, turn),
                ),
                tuple(turned_shape(shape, place(shape.position), turn) for shape in link.shapes),
            )
            for link in self.links
        )
        joints = tuple(
            replace(one, hinge=place(one.hinge), axis=geometry.rotate(turn, one.axis))
            for one in self.joints
        )
        return replace(self, links=links, joints=joints)


def placed_link(name: str, pose: Pose, inertial: Inertial, shapes: tuple[Shape, ...]) -> FlatLink:
    """Return a link whose inertial and shapes are given in its own frame."""
    moved = tuple(turned_shape(one, pose.point(one.position), pose.rotation) for one in shapes)
    return FlatLink(name, pose, solids.placed(inertial, pose.position, pose.rotation), moved)


def flat_chain(chain: Chain) -> FlatModel:
    """Return a chain as a flat model, each axis of an actuator a group."""
    poses = link_poses(chain, (0.0,) * len(chain.joints), Pose())
    links = tuple(
        placed_link(link.name, pose, link.inertial, link.shapes)
        for link, pose in zip(chain.links, poses, strict=True)
    )
    groups: dict[tuple[int, int], int] = {}
    joints = tuple(
        FlatJoint(
            joint.name,
            joint.parent,
            pose.position,
            geometry.rotate(pose.rotation, joint.axis),
            joint.lower,
            joint.upper,
            joint.effort,
            joint.velocity,
            joint.stiffness,
            joint.damping,
            joint.neutral_position,
            joint.friction,
            groups.setdefault((joint.actuator, joint.channel), len(groups)),
        )
        for joint, pose in zip(chain.joints, poses[1:], strict=True)
    )
    return FlatModel(chain.name, links, joints)


def turned_shape(shape: Shape, position: Vector, rotation: geometry.Matrix) -> Shape:
    """Return a shape at a position, turned by a rotation."""
    turned = geometry.multiply(rotation, geometry.rotation_from_rpy(shape.rpy))
    return replace(shape, position=position, rpy=precise_rpy(turned))


def rescaled(flat: FlatModel, scale: Scale) -> FlatModel:
    """Return a model in the units of a scale, from SI."""
    links = tuple(
        FlatLink(
            link.name,
            Pose(geometry.scaled(link.pose.position, scale.length), link.pose.rotation),
            scaled(link.inertial, scale),
            tuple(scaled(shape, scale) for shape in link.shapes),
        )
        for link in flat.links
    )
    torque, damping = (scale.factor(Dimension(1, 2, time)) for time in (-2, -1))
    joints = tuple(
        replace(
            joint,
            hinge=geometry.scaled(joint.hinge, scale.length),
            effort=joint.effort * torque,
            stiffness=joint.stiffness * torque,
            damping=joint.damping * damping,
            friction=joint.friction * torque,
        )
        for joint in flat.joints
    )
    return replace(flat, links=links, joints=joints)
