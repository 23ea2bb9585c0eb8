"""Errors of recorded rows against a reference, over time, for each quantity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.scene.model import Quantity
from somo_cli.scene.quantities import BODY_COLUMNS
from somo_cli.simulation.plan.model import Plan

UNITS: dict[Quantity, str] = {name: row.unit for name, row in BODY_COLUMNS.items()}

_VECTOR = 3  # columns of a position
_QUATERNION = 4  # columns of a unit quaternion


@dataclass(frozen=True, slots=True)
class ErrorSummary:
    """An error at the end, its maximum over time, and its root mean square over time."""

    final: float
    maximum: float
    rms: float


def summarize_errors(profile: Array) -> ErrorSummary:
    """Return the summary of an error over time, shape (instants,)."""
    return ErrorSummary(
        float(profile[-1]), float(profile.max()), float(np.sqrt(np.mean(np.square(profile))))
    )


def error_profiles(plan: Plan, rows: Array, reference: Array) -> dict[Quantity, Array]:
    """Return the error of each quantity over time, shape (rows,), the largest over all bodies.

    `rows` and `reference`, shape (rows, columns), are recorded at the same instants. The error of a
    position or a pose is a distance [m], that of energy is of the sum of its forms [J], that of an
    orientation is the distance of unit quaternions, half the angle if that is small. For other
    quantities it is the largest absolute difference. Contact forces are left out: their values at
    an instant do not converge, their impulses do (`recorded_errors`).
    """
    found: dict[Quantity, Array] = {}
    for group in columns.body_column_groups(plan.recorded):
        if "contacts" in group.columns.needs:
            continue
        part = slice(group.first, group.last)
        error = _error_profile(group.quantity, rows[:, part], reference[:, part])
        found[group.quantity] = np.maximum(found.get(group.quantity, 0.0), error)
    return found


def align_quaternions(quantity: Quantity, values: Array, reference: Array) -> Array:
    """Return values whose unit quaternions have the sign nearest to that of the reference.

    The quaternions q and -q are the same rotation.
    """
    if quantity == "base_pose":
        turned = align_quaternions("link_orientations", values[:, _VECTOR:], reference[:, _VECTOR:])
        return np.hstack([values[:, :_VECTOR], turned])
    if quantity != "link_orientations":
        return values
    turns, others = (table.reshape(len(table), -1, _QUATERNION) for table in (values, reference))
    sides = np.where(np.sum(turns * others, axis=2, keepdims=True) < 0, -1.0, 1.0)
    return (turns * sides).reshape(values.shape)


def _error_profile(quantity: Quantity, values: Array, reference: Array) -> Array:
    difference = align_quaternions(quantity, values, reference) - reference
    if quantity == "energy":
        total: Array = np.abs(difference.sum(axis=1))
        return total
    if quantity == "base_pose":
        difference = difference[:, :_VECTOR]
    vectors = difference.reshape(len(difference), -1, BODY_COLUMNS[quantity].vector)
    largest: Array = np.linalg.norm(vectors, axis=2).max(axis=1, initial=0.0)
    return largest
