"""The reference of errors: the limit of a scene for vanishing time steps, with its own error."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from somo_cli.analysis.errors import align_quaternions, error_profiles
from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.scene import columns
from somo_cli.scene.model import Quantity
from somo_cli.simulation.plan.model import Plan

PLAUSIBLE_ORDERS = (0.75, 2.75)
"""Range of observed orders that is accepted of methods and chains of order 1 or 2."""

ORDER_TOLERANCE = 0.25
"""Distance from a whole number within which that is the order; higher terms cause the rest."""

ATTEMPTS = 4
ROUNDING = 1e-14  # difference of runs, over the largest value, that is only rounding

RunAtTimeStep: TypeAlias = Callable[[float], Array]
"""Simulates with a time step [s] and returns the rows at common instants."""


@dataclass(frozen=True, slots=True)
class ExtrapolatedRows:
    """Rows at the common instants, and the error and observed order of each quantity.

    `error` (the maximum over time) and `final_error` are conservative estimates, in the unit of the
    quantity. The order is nan where none can be observed.
    """

    rows: Array
    error: dict[Quantity, float]
    final_error: dict[Quantity, float]
    order: dict[Quantity, float]


@dataclass(frozen=True, slots=True)
class Reference(ExtrapolatedRows):
    """The limit of a scene, the finest time step of the runs behind it [s], and its kind."""

    time_step: float
    kind: str = "self-converged"


def converged_reference(plan: Plan, time_step: float, recorded: RunAtTimeStep) -> Reference:
    """Return the reference from runs with this step [s], half of it and a quarter of it.

    If a run diverges, all are repeated with half the step, up to ATTEMPTS times. Raises
    SimulationDiverged.
    """
    for attempt in range(ATTEMPTS):
        step = time_step / 2**attempt
        try:
            levels = [recorded(step / 2**level) for level in range(3)]
        except SimulationDiverged:
            if attempt == ATTEMPTS - 1:
                raise
            continue
        limit = extrapolate(plan, levels, 2.0)
        return Reference(limit.rows, limit.error, limit.final_error, limit.order, step / 4)
    raise AssertionError("the last attempt returns or raises")


def extrapolate(plan: Plan, levels: Sequence[Array], ratio: float) -> ExtrapolatedRows:
    """Return Richardson's limit of three levels, coarse to fine, with its error and the orders.

    Let p be the order observed in a quantity, or the whole number that it is close to, and r the
    ratio of the steps. The limit is y3 + (y3 - y2) / (r^p - 1). Its error is the larger of two
    estimates. The first is the difference of the limits of the finer and of the coarser pair, over
    r^p - 1 since the rest falls at least as fast. The second, as both pairs agree where p was
    observed in them, is the change of the limit between the observed and the whole order.
    If no order is plausible the limit is y3, and its error
    the last change: Roache, J. Fluids Eng. 116 (1994) 405.
    """
    first, second, third = (_with_aligned_quaternions(plan, level, levels[2]) for level in levels)
    before, after = error_profiles(plan, first, second), error_profiles(plan, second, third)
    seen = {
        quantity: _order(float(before[quantity].max()), float(after[quantity].max()), ratio)
        for quantity in after
    }
    factor, apart = np.zeros((2, third.shape[1]))
    groups = [one for one in columns.body_column_groups(plan.recorded) if one.quantity in seen]
    for group in groups:
        part = slice(group.first, group.last)
        order = seen[group.quantity]
        if PLAUSIBLE_ORDERS[0] <= order <= PLAUSIBLE_ORDERS[1]:
            near = round(order)
            used = near if abs(order - near) <= ORDER_TOLERANCE else order
            factor[part] = 1 / (ratio**used - 1)
            apart[part] = abs(1 / (ratio**order - 1) - 1 / (ratio**near - 1))
    rows = third + factor * (third - second)
    coarser = second + factor * (second - first)
    # shifted rows, so that each quantity measures its error in its own way
    by_pairs = error_profiles(plan, rows, rows + np.where(factor > 0, factor, 1) * (coarser - rows))
    by_order = error_profiles(plan, rows, rows + apart * (third - second))
    error: dict[Quantity, float] = {}
    final_error: dict[Quantity, float] = {}
    for group in groups:
        size = np.abs(third[:, group.first : group.last]).max(initial=0.0)
        profile = np.maximum(by_pairs[group.quantity], by_order[group.quantity])
        least = ROUNDING * float(size)
        error[group.quantity] = max(float(profile.max()), least, error.get(group.quantity, 0.0))
        final_error[group.quantity] = max(float(profile[-1]), least)
    return ExtrapolatedRows(rows, error, final_error, seen)


def _order(before: float, after: float, ratio: float) -> float:
    return math.log(before / after, ratio) if before > 0 and after > 0 else math.nan


def _with_aligned_quaternions(plan: Plan, rows: Array, reference: Array) -> Array:
    turned = rows.copy()
    for group in columns.body_column_groups(plan.recorded):
        part = slice(group.first, group.last)
        turned[:, part] = align_quaternions(group.quantity, rows[:, part], reference[:, part])
    return turned
