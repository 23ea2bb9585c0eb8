"""The explicit law on either side of its predicted limit."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.analysis.modes import SingularInertia
from somo_cli.analysis.stability import forecast_of
from somo_cli.problems import EngineRefused, SimulationDiverged
from tests.builders.runs import rows_of
from tests.extreme.case import Case

MARGIN = 1.05
FACTORS = (MARGIN, 1.1, 1.2, 1.5, 2.0, 4.0, 10.0)
STEPS = 500  # beyond the limit by 5 % the fastest mode grows by 1.8, damped ones less, in each


@dataclass(frozen=True, slots=True)
class Edge:
    """The predicted limit [s], and by which of FACTORS it is at least off; infinity: by more.

    `optimism` divides the limit for the first step that holds, `pessimism` multiplies it for the
    first that does not; both are MARGIN where the prediction is right.
    """

    limit: float
    optimism: float
    pessimism: float


def edge(case: Case) -> Edge | None:
    """Find where the explicit law fails; None where nothing is predicted, or nothing can run."""
    limit = predicted_limit(case)
    if limit is None or _is_refused(case):
        return None
    below = (one for one in FACTORS if is_stable(case, limit / one))
    above = (one for one in FACTORS if not is_stable(case, limit * one))
    return Edge(limit, next(below, float("inf")), next(above, float("inf")))


def predicted_limit(case: Case) -> float | None:
    """Return the largest explicit step [s] by the product's own prediction."""
    plan = case.plan("explicit", case.time_step, 1)
    try:
        return forecast_of(plan, plan.bodies[0]).explicit_step
    except SingularInertia:
        return None


def _is_refused(case: Case) -> bool:
    try:
        rows_of(case.plan("explicit", case.time_step, 1), 0)
    except EngineRefused:
        return True
    return False


def is_stable(case: Case, time_step: float) -> bool:
    """Whether the explicit law runs through with this step [s]."""
    try:
        rows_of(case.plan("explicit", time_step, STEPS), STEPS)
    except SimulationDiverged:
        return False
    return True
