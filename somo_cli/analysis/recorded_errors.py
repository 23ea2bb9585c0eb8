"""Errors of all that a scene with contact or objects records, beside those of tips and angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.column_families import column_families, force_columns
from somo_cli.analysis.error_estimate import (
    CONVERGENCE_ORDER,
    ColumnError,
    distances,
    errors_of_finer_run,
)
from somo_cli.analysis.level_comparison import (
    DifferenceAccumulator,
    OrderAccumulator,
    QuaternionAlignment,
)
from somo_cli.analysis.observed_order import ObservedOrder
from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.simulation.plan.model import Plan


@dataclass(frozen=True, slots=True)
class RecordedErrors:
    """What a run of a scene with contact or objects is off by, and what touched.

    `by_family` has the column with the largest error of each family of columns, `worst` the one
    with the largest error relative to its scale of those that the scene records. `forces` are mean
    normal forces [N] over the run by the names of the two bodies, of all pairs that can touch.
    `events` is how often two links began to press on each other. `columns` are the errors of all
    columns but the time, and `ends` their last values, with the quaternions' signs of the finest
    run.
    """

    by_family: tuple[ColumnError, ...]
    worst: ColumnError | None
    forces: Mapping[tuple[str, str], float]
    events: int
    columns: tuple[ColumnError, ...]
    ends: Array

    @property
    def relative(self) -> float:
        """The largest error relative to its scale of what the scene records."""
        return 0.0 if self.worst is None else self.worst.relative

    def of_object(self, name: str, unit: str) -> float:
        """Return the largest error of the pose of an object: in "m", or half an angle in "1"."""
        found = [
            one.judged
            for one in self.by_family
            if one.unit == unit and one.name.startswith(f"{name}.pose.")
        ]
        return max(found, default=0.0)


def reference_errors(
    plan: Plan, levels: Sequence[Array], recorded: frozenset[str], events: int
) -> RecordedErrors:
    """Return the errors of the finest of three levels, coarse to fine, by their differences.

    The rows are at common instants, with impulses behind their columns. `recorded` are the names of
    the columns that the scene records.
    """
    differences, order = DifferenceAccumulator(plan), OrderAccumulator(plan)
    differences.add(levels[1], levels[2])
    order.add(*levels)
    nominal = ObservedOrder(np.nan, CONVERGENCE_ORDER["implicit"])
    errors = errors_of_finer_run(plan, differences.differences(), order, nominal)
    return _summary(plan, levels[2], levels[2], errors, recorded, events)


def case_errors(
    plan: Plan, rows: Array, reference: Array, recorded: frozenset[str], events: int
) -> RecordedErrors:
    """Return the distances of the rows of a case from those of the finest run."""
    differences = DifferenceAccumulator(plan)
    differences.add(rows, reference)
    errors = distances(plan, differences.differences())
    return _summary(plan, rows, reference, errors, recorded, events)


def _summary(
    plan: Plan,
    rows: Array,
    reference: Array,
    errors: Sequence[ColumnError],
    recorded: frozenset[str],
    events: int,
) -> RecordedErrors:
    by_family = tuple(
        max((errors[column - 1] for column in family.columns), key=lambda one: one.judged)
        for family in column_families(plan.recorded)
    )
    told = [one for one in errors if one.name in recorded]
    worst = max(told, key=lambda one: one.relative, default=None)
    last = QuaternionAlignment(plan)(rows[-1:], reference[-1:])[0, 1 : len(errors) + 1]
    forces = _mean_forces(plan, rows)
    return RecordedErrors(by_family, worst, forces, events, tuple(errors), last)


def _mean_forces(plan: Plan, rows: Array) -> dict[tuple[str, str], float]:
    """Return the mean normal force of each pair [N], from the impulse at the last row."""
    names = columns.header(plan.recorded)
    places = {names[column]: place for place, column in enumerate(force_columns(plan.recorded))}
    bodies, duration = plan.recorded.names, float(rows[-1, 0])
    found = {}
    for number, name in enumerate(bodies):
        for other in bodies[number + 1 :]:
            place = places.get(f"{name}.contact.{other}.normal_n")
            if place is not None:
                found[name, other] = float(rows[-1, len(names) + place]) / duration
    return found
