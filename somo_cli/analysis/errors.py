"""How far recorded rows are from a reference: one error over time for each quantity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation import columns
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.scene import Quantity

UNITS: dict[Quantity, str] = {
    "joint_angles": "rad",
    "joint_rates": "rad/s",
    "spring_torques": "N·m",
    "actuation": "N·m",
    "link_positions": "m",
    "link_orientations": "1",
    "base_pose": "m",
    "tip_position": "m",
    "curvatures": "1/m",
    "energy": "J",
    "contact_force": "N",
    "contact_pairs": "N",
    "link_contact_forces": "N",
}

_PLACES = 3  # columns that are one vector, whose length is what counts
_TURNS = 4  # columns that are one unit quaternion


@dataclass(frozen=True, slots=True)
class Error:
    """An error at the end, at its worst, and as the root of its mean square over time."""

    final: float
    maximum: float
    rms: float


def summary(profile: Array) -> Error:
    """Return what to say of an error over time, shape (instants,)."""
    return Error(
        float(profile[-1]), float(profile.max()), float(np.sqrt(np.mean(np.square(profile))))
    )


def profiles(plan: Plan, rows: Array, reference: Array) -> dict[Quantity, Array]:
    """Return the error of each quantity over time, shape (rows,), the largest over all bodies.

    `rows` and `reference`, shape (rows, columns), are recorded at the same instants. A position
    counts by its distance [m], a pose by its position, an energy by the sum of its parts [J], a
    link's orientation by the distance of unit quaternions, which is half the angle for small
    ones; everything else by its largest value.
    """
    found: dict[Quantity, Array] = {}
    for group in columns.groups(plan):
        part = slice(group.first, group.last)
        error = _profile(group.quantity, rows[:, part], reference[:, part])
        found[group.quantity] = np.maximum(found.get(group.quantity, 0.0), error)
    return found


def aligned(quantity: Quantity, values: Array, reference: Array) -> Array:
    """Return the values with unit quaternions on the reference's side: q and -q are one turn."""
    if quantity == "base_pose":
        turned = aligned("link_orientations", values[:, _PLACES:], reference[:, _PLACES:])
        return np.hstack([values[:, :_PLACES], turned])
    if quantity != "link_orientations":
        return values
    turns, others = (table.reshape(len(table), -1, _TURNS) for table in (values, reference))
    sides = np.where(np.sum(turns * others, axis=2, keepdims=True) < 0, -1.0, 1.0)
    return (turns * sides).reshape(values.shape)


def _profile(quantity: Quantity, values: Array, reference: Array) -> Array:
    difference = aligned(quantity, values, reference) - reference
    if quantity == "energy":
        total: Array = np.abs(difference.sum(axis=1))
        return total
    if quantity == "base_pose":
        difference = difference[:, :_PLACES]
    width = {"tip_position": _PLACES, "base_pose": _PLACES, "link_positions": _PLACES}
    width |= {"link_orientations": _TURNS}
    vectors = difference.reshape(len(difference), -1, width.get(quantity, 1))
    largest: Array = np.linalg.norm(vectors, axis=2).max(axis=1, initial=0.0)
    return largest
