"""The values of a body's columns in SI, from its states in several rows at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.model import Quantity
from somo_cli.scene.quantities import channels
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.forward_kinematics import (
    ForwardKinematics,
    Frames,
    frames_from_poses,
    point_positions,
    quaternions,
)
from somo_cli.simulation.engine.contacts import ContactPoint
from somo_cli.simulation.plan.model import Body
from somo_cli.simulation.plan.units import UnitFactors
from somo_cli.simulation.recording import contact_values


@dataclass
class BodyStates:
    """One body in several rows, in engine units: angles and rates, shape (n, rows).

    `actuation`, shape (n, rows), is in N·m. `base_poses` are those of the base's URDF frame in the
    world, if a column needs them, one for each row or one for all; `base_velocities` hold the
    velocity of the base's centre of mass and its angular velocity, in the world. `number` is that
    of the body. `contacts` lists all contact points of the step before each row.
    """

    body: Body
    angles: Array
    rates: Array
    actuation: Array
    base_poses: Sequence[Pose]
    base_velocities: Sequence[tuple[Vector, Vector]]
    gravity: Vector
    poses: ForwardKinematics
    dynamics: Callable[[], ChainDynamics]
    number: int = 0
    others: Sequence[int] = ()
    contacts: Sequence[Sequence[ContactPoint]] = ()

    @cached_property
    def base_frames(self) -> Frames:
        """The frames of the base, shapes (3, rows) and (3, 3, rows), or of one row for all."""
        return frames_from_poses(self.base_poses)

    @cached_property
    def frames(self) -> Frames:
        """Every link frame in the world, root first."""
        return self.poses.frames(self.angles, self.base_frames)


BodyValueReader: TypeAlias = Callable[[BodyStates, UnitFactors], Array]
"""Returns the columns of a quantity, shape (columns, rows), or (columns, 1) if no row differs."""


def _angles(states: BodyStates, units: UnitFactors) -> Array:
    return states.angles


def _rates(states: BodyStates, units: UnitFactors) -> Array:
    return states.rates


def _spring_torques(states: BodyStates, units: UnitFactors) -> Array:
    joints = states.body.chain.joints
    stiffness = np.array([[joint.stiffness] for joint in joints])
    neutral = np.array([[joint.neutral_position] for joint in joints])
    torques: Array = -stiffness * (states.angles - neutral) / units.torque
    return torques


def _actuation(states: BodyStates, units: UnitFactors) -> Array:
    joints = [(joint.actuator, joint.channel) for joint in states.body.chain.joints]
    first = [joints.index(channel) for channel in channels(states.body.chain)]
    return np.asarray(states.actuation[first])


def _curvatures(states: BodyStates, units: UnitFactors) -> Array:
    spans = np.array([[joint.span / units.length] for joint in states.body.chain.joints])
    return np.asarray(states.angles / spans)


def _link_positions(states: BodyStates, units: UnitFactors) -> Array:
    positions, _ = states.frames
    return positions.reshape(-1, positions.shape[-1]) / units.length


def _link_orientations(states: BodyStates, units: UnitFactors) -> Array:
    turns = quaternions(states.frames[1])
    return turns.reshape(-1, turns.shape[-1])


def _base_pose(states: BodyStates, units: UnitFactors) -> Array:
    positions, rotations = states.base_frames
    return np.concatenate([positions / units.length, quaternions(rotations)])


def _tip_position(states: BodyStates, units: UnitFactors) -> Array:
    return np.concatenate(
        [point_positions(states.frames, link, tip) / units.length for link, tip in _ends(states)]
    )


def _tip_orientation(states: BodyStates, units: UnitFactors) -> Array:
    turns = quaternions(states.frames[1])  # (links, 4, rows)
    return np.concatenate([turns[link] for link, _ in _ends(states)])


def _tip_velocity(states: BodyStates, units: UnitFactors) -> Array:
    """Return the velocity of each tip: that of the base's motion there, and that of the joints."""
    rows = states.angles.shape[1]
    bases = states.base_poses if len(states.base_poses) == rows else [*states.base_poses] * rows
    found = []
    for row, (base, (velocity, spin)) in enumerate(zip(bases, states.base_velocities, strict=True)):
        pose = states.dynamics().at(states.angles[:, row], base)
        own: list[Array] = []
        for (link, tip), jacobian in zip(_ends(states), pose.tip_jacobians(), strict=True):
            arm = pose.point(link, tip) - pose.centres[0]
            own.append(np.cross(spin, arm) + velocity + jacobian @ states.rates[:, row])
        found.append(np.concatenate(own))
    return np.array(found).T / units.length


def _bending_angles(states: BodyStates, units: UnitFactors) -> Array:
    """Return the sum of the joint angles of each actuator and axis."""
    joints = [(joint.actuator, joint.channel) for joint in states.body.chain.joints]
    return np.array(
        [
            states.angles[[index for index, own in enumerate(joints) if own == channel]].sum(axis=0)
            for channel in channels(states.body.chain)
        ]
    )


def _ends(states: BodyStates) -> list[tuple[int, Vector]]:
    """Return the last link of each backbone, and its tip in the frame of that link."""
    chain = states.body.chain
    return [(limb.last_link, limb.tip) for limb in chain.limbs] or [(-1, chain.tip)]


def _energy(states: BodyStates, units: UnitFactors) -> Array:
    dynamics, rows = states.dynamics(), states.angles.shape[1]
    bases = states.base_poses if len(states.base_poses) == rows else [*states.base_poses] * rows
    found = []
    for row, (base, (velocity, spin)) in enumerate(zip(bases, states.base_velocities, strict=True)):
        pose = dynamics.at(states.angles[:, row], base)
        found.append(
            (
                pose.kinetic_energy([*spin, *velocity, *states.rates[:, row].tolist()]),
                pose.elastic_energy(),
                pose.gravity_energy(states.gravity),
            )
        )
    return np.array(found).T / units.torque


def _link_contact_forces(states: BodyStates, units: UnitFactors) -> Array:
    number, count = states.number, len(states.body.chain.links)
    return np.array(
        [contact_values.link_forces(row, number, count, units) for row in states.contacts]
    ).T


BODY_VALUES: dict[Quantity, BodyValueReader] = {
    "joint_angles": _angles,
    "joint_rates": _rates,
    "spring_torques": _spring_torques,
    "actuation": _actuation,
    "curvatures": _curvatures,
    "link_positions": _link_positions,
    "link_orientations": _link_orientations,
    "base_pose": _base_pose,
    "tip_position": _tip_position,
    "tip_velocity": _tip_velocity,
    "tip_orientation": _tip_orientation,
    "bending_angles": _bending_angles,
    "energy": _energy,
    "contact_force": contact_values.total_forces,
    "contact_pairs": contact_values.forces_of_partners,
    "link_contact_forces": _link_contact_forces,
}
