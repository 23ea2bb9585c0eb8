"""The values of an object's columns in SI, from its states in several rows at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.rigid_object import ObjectQuantity
from somo_cli.simulation.dynamics.forward_kinematics import frames_from_poses, quaternions
from somo_cli.simulation.engine.contacts import ContactPoint
from somo_cli.simulation.plan.units import UnitFactors
from somo_cli.simulation.recording import contact_values


@dataclass
class ObjectStates:
    """One object in several rows, in engine units and the world frame; empty where not needed.

    `number` counts objects after all bodies. `contacts` lists all contact points of the step
    before each row. `total_rotations` are those of RotationCounter [rad]; `velocities` hold the
    velocity of the centre of mass and the angular velocity.
    """

    number: int
    others: Sequence[int]
    poses: Sequence[Pose]
    velocities: Sequence[tuple[Vector, Vector]]
    total_rotations: Sequence[Vector]
    contacts: Sequence[Sequence[ContactPoint]]


ObjectValueReader: TypeAlias = Callable[[ObjectStates, UnitFactors], Array]
"""Returns the columns of a quantity, shape (columns, rows)."""


def _pose(states: ObjectStates, units: UnitFactors) -> Array:
    positions, rotations = frames_from_poses(states.poses)
    return np.concatenate([positions / units.length, quaternions(rotations)])


def _velocity(states: ObjectStates, units: UnitFactors) -> Array:
    linear, spins = np.moveaxis(np.array(states.velocities), 0, -1)
    return np.concatenate([linear / units.length, spins])


def _angles(states: ObjectStates, units: UnitFactors) -> Array:
    return np.array(states.total_rotations).T


OBJECT_VALUES: dict[ObjectQuantity, ObjectValueReader] = {
    "pose": _pose,
    "velocity": _velocity,
    "angles": _angles,
    "contact_force": contact_values.total_forces,
    "contact_pairs": contact_values.forces_of_partners,
}
