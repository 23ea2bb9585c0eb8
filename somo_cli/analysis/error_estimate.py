"""The error of each column of a run, estimated from the same scene at other time steps."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field, replace

import numpy as np

from somo_cli.analysis.column_families import column_families
from somo_cli.analysis.column_scales import scales
from somo_cli.analysis.level_comparison import Differences, LevelRows, OrderAccumulator, compare
from somo_cli.analysis.observed_order import ObservedOrder, observed_order
from somo_cli.analysis.spooled_run import LevelRunner, ReadRows, SpooledRun
from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.scene import columns
from somo_cli.scene.model import Integrator
from somo_cli.simulation.plan.model import Plan

CONVERGENCE_ORDER: dict[Integrator, int] = {"implicit": 2, "euler": 1, "explicit": 1}
"""Order of convergence of each integrator, where motion is smooth."""


@dataclass(frozen=True, slots=True)
class ColumnError:
    """The estimated error of one column, in its unit.

    `final`, `maximum` and `rms` are of the values at the rows. `judged` is by the measure of the
    column's family, and `relative` is that over `scale`.
    """

    name: str
    unit: str
    measure: str
    final: float
    maximum: float
    rms: float
    judged: float
    scale: float
    order: ObservedOrder

    @property
    def relative(self) -> float:
        """The error over the scale; 0 for a column that is the same in all runs."""
        return self.judged / self.scale if self.scale > 0 else 0.0


@dataclass(frozen=True, slots=True)
class ErrorEstimate:
    """The estimated error of every column but the time, and what the other runs took [s].

    The errors are those of the run at `time_step` [s], and none if only its start was recorded;
    `others` are the steps of the runs that it was compared with. `levels` are the steps of three
    runs, coarse to fine, and `ends` their values at the last common instant, shape (3, columns);
    there are neither if there were two runs.
    """

    time_step: float
    others: tuple[float, ...]
    order: int
    errors: tuple[ColumnError, ...]
    run_time: float
    levels: tuple[float, ...] = ()
    ends: Array = field(default_factory=lambda: np.empty((0, 0)))


def estimate(
    plan: Plan, rows: Callable[[], ReadRows], steps: int, runner: LevelRunner
) -> ErrorEstimate:
    """Run a plan again at twice and at half the step, and compare the rows.

    `rows()` gives the rows of the run from the start, with impulses. y(h) - y(h/2) is the error of
    y(h) times 1 - 2^-p, with the order p that y(2h) - y(h) shows: Richardson, Phil. Trans. R. Soc.
    A 226 (1927) 299. A run that diverges at twice the step is replaced by one at a quarter. Raises
    SimulationDiverged and EngineRefused.
    """
    # all runs last for the same time, so the others have no stop conditions
    plan = replace(plan, stop_conditions=())
    coarser, stride = coarser_plan(plan)
    with ExitStack() as stack:

        def run(other: Plan, count: int) -> SpooledRun:
            return runner.run(other, count, stack.enter_context(runner.open_file()))

        def finer(factor: int) -> LevelRows:
            return LevelRows(run(finer_plan(plan, factor), factor * steps).reader())

        try:
            # a run may be too short for one at twice the step
            has_coarser = steps >= 2 * stride * plan.every
            doubled = run(coarser, steps // 2) if has_coarser else None
        except SimulationDiverged:
            half, quarter = finer(2), finer(4)
            factors: tuple[float, ...] = (2, 4)
            found, order = compare(plan, [LevelRows(rows()), half, quarter], (0, 1))
        else:
            half = finer(2)
            own = LevelRows(rows())
            if doubled is None:
                factors = (2,)
                found, order = compare(plan, [own, half], (0, 1))
            else:
                factors = (0.5, 2)
                levels = [LevelRows(doubled.reader(), stride), own, half]
                found, order = compare(plan, levels, (1, 2))
    nominal = CONVERGENCE_ORDER[plan.integrator]
    unknown = ObservedOrder(math.nan, nominal, is_striking=runner.has_struck_limits)
    errors: tuple[ColumnError, ...] = ()
    if found is not None:
        errors = errors_of_run(plan, found, order, unknown)
    others = tuple(plan.time_step / factor for factor in factors)
    base = ErrorEstimate(plan.time_step, others, nominal, errors, runner.run_time)
    if order is None or not len(order.ends):
        return base
    by_size = tuple(sorted((plan.time_step, *others), reverse=True))
    return replace(base, levels=by_size, ends=order.ends)


def errors_of_run(
    plan: Plan, found: Differences, order: OrderAccumulator | None, unknown: ObservedOrder
) -> tuple[ColumnError, ...]:
    """Return the errors of a run from its differences to one at half the step.

    `unknown` is the order of all columns if none was observed.
    """
    return _errors(plan, found, order, unknown, lambda seen: seen.share_of_run)


def errors_of_finer_run(
    plan: Plan, found: Differences, order: OrderAccumulator | None, unknown: ObservedOrder
) -> tuple[ColumnError, ...]:
    """Return the errors of the run at half the step from the same."""
    return _errors(plan, found, order, unknown, lambda seen: seen.share_of_finer)


def distances(plan: Plan, found: Differences) -> tuple[ColumnError, ...]:
    """Return the plain distances of a run from one that is so fine that it counts as right."""
    return _errors(plan, found, None, ObservedOrder(math.nan, 1), lambda seen: 1.0)


def _errors(
    plan: Plan,
    found: Differences,
    order: OrderAccumulator | None,
    unknown: ObservedOrder,
    share: Callable[[ObservedOrder], float],
) -> tuple[ColumnError, ...]:
    names = columns.header(plan.recorded)
    families = column_families(plan.recorded)
    errors: dict[int, ColumnError] = {}
    for family, scale in zip(families, scales(plan, families, found.range), strict=True):
        seen = unknown
        if order is not None:
            seen = observed_order(*order.products(family), unknown.nominal, unknown.is_striking)
        factor = share(seen)
        for column in family.columns:
            at = column - 1
            errors[column] = ColumnError(
                name=names[column],
                unit=family.unit,
                measure=family.measure,
                final=factor * float(found.final[at]),
                maximum=factor * float(found.largest[at]),
                rms=factor * float(found.rms[at]),
                judged=factor * float(found.judged[at]),
                scale=scale,
                order=seen,
            )
    return tuple(errors[column] for column in sorted(errors))


def coarser_plan(plan: Plan) -> tuple[Plan, int]:
    """Return the plan at twice the step, and which of the rows both have: every one, or second."""
    stride = 1 if plan.every % 2 == 0 else 2
    coarser = replace(
        plan,
        time_step=2 * plan.time_step,
        every=plan.every // 2 if stride == 1 else plan.every,
    )
    return coarser, stride


def finer_plan(plan: Plan, factor: int) -> Plan:
    """Return the plan at its step over a whole number, with rows at the same instants."""
    return replace(plan, time_step=plan.time_step / factor, every=plan.every * factor)
