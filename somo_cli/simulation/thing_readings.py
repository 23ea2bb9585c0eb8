"""The values of an object's columns in SI, from its states in several rows at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation import contact_columns
from somo_cli.simulation.poses import frames_of, quaternions
from somo_cli.simulation.things import Reading
from somo_cli.simulation.touching import Touch
from somo_cli.simulation.units import Units


@dataclass
class ThingStates:
    """One object at several instants, in engine units and the world's axes; what columns need.

    `number` is that of the object behind all bodies, and `touches` what touched anything in the
    step before each row. `turned` is how far it has turned since the start, as `turning` counts
    it [rad]; `velocities` hold that of its centre, and its spin.
    """

    number: int
    others: Sequence[int]
    poses: Sequence[Pose]
    velocities: Sequence[tuple[Vector, Vector]]
    turned: Sequence[Vector]
    touches: Sequence[Sequence[Touch]]


ThingReader: TypeAlias = Callable[[ThingStates, Units], Array]
"""Returns the columns of a reading, shape (columns, rows)."""


def _pose(states: ThingStates, units: Units) -> Array:
    positions, rotations = frames_of(states.poses)
    return np.concatenate([positions / units.length, quaternions(rotations)])


def _velocity(states: ThingStates, units: Units) -> Array:
    straight, spins = np.moveaxis(np.array(states.velocities), 0, -1)
    return np.concatenate([straight / units.length, spins])


def _angles(states: ThingStates, units: Units) -> Array:
    return np.array(states.turned).T


def _contact_force(states: ThingStates, units: Units) -> Array:
    number = states.number
    return np.array([contact_columns.total(row, number, units) for row in states.touches]).T


def _contact_pairs(states: ThingStates, units: Units) -> Array:
    number, others = states.number, states.others
    return np.array([contact_columns.pairs(row, number, others, units) for row in states.touches]).T


READINGS: dict[Reading, ThingReader] = {
    "pose": _pose,
    "velocity": _velocity,
    "angles": _angles,
    "contact_force": _contact_force,
    "contact_pairs": _contact_pairs,
}
