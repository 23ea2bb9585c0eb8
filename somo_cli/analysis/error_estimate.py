"""The error of each column of a run, estimated from the same scene with half the time step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from somo_cli.analysis.errors import ErrorSummary
from somo_cli.analysis.recorded_run import Clock, OpenWorld
from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.scene.model import Integrator
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import run

CONVERGENCE_ORDER: dict[Integrator, int] = {"implicit": 2, "euler": 1, "explicit": 1}
"""Order of convergence of each integrator."""


@dataclass(frozen=True, slots=True)
class ErrorEstimate:
    """The estimated error of every column but the time, and the run time of the second run [s].

    The errors are those of the run itself, not of the second, finer run.
    """

    order: int
    errors: tuple[ErrorSummary, ...]
    run_time: float


def estimate(
    plan: Plan,
    rows: Callable[[int], Array],
    steps: int,
    open_world: OpenWorld,
    clock: Clock,
    advance: Callable[[int], None] = lambda done: None,
) -> ErrorEstimate:
    """Run a plan again with half the step and compare the rows; `rows(n)` returns the next n.

    For an integrator of order p, y(h) - y(h/2) is the error of y(h) times 1 - 2^-p: Richardson,
    Phil. Trans. R. Soc. A 226 (1927) 299. Raises SimulationDiverged and EngineRefused.
    """
    order = CONVERGENCE_ORDER[plan.integrator]
    accumulator = _ErrorAccumulator(plan, rows, 1 / (1 - 2.0**-order))
    # both runs last for the same time, so the second has no stop conditions
    half = replace(plan, time_step=plan.time_step / 2, every=plan.every * 2, stop_conditions=())
    with open_world(half) as world:
        run_time = run(half, world, accumulator.compare, 2 * steps, clock, advance).wall_time
    return ErrorEstimate(order, accumulator.errors(), run_time)


class _ErrorAccumulator:
    """Compares each row of the finer run with its counterpart."""

    def __init__(self, plan: Plan, rows: Callable[[int], Array], factor: float) -> None:
        self._quaternions = [list(one) for one in columns.quaternion_columns(plan.recorded)]
        self._rows = rows
        self._factor = factor
        width = len(columns.header(plan.recorded)) - 1
        self._last: Array = np.zeros(width)
        self._largest: Array = np.zeros(width)
        self._squares: Array = np.zeros(width)
        self._count = 0

    def compare(self, fine: Array) -> None:
        coarse = self._rows(len(fine)).copy()
        for part in self._quaternions:
            # q and -q are the same rotation
            is_opposite = np.sum(coarse[:, part] * fine[:, part], axis=1) < 0
            coarse[np.ix_(is_opposite, part)] *= -1
        difference = self._factor * np.abs(coarse - fine)[:, 1:]
        self._last = difference[-1]
        self._largest = np.maximum(self._largest, difference.max(axis=0))
        self._squares += np.sum(difference**2, axis=0)
        self._count += len(fine)

    def errors(self) -> tuple[ErrorSummary, ...]:
        rms = np.sqrt(self._squares / max(1, self._count))
        return tuple(
            ErrorSummary(final, most, mean)
            for final, most, mean in zip(
                self._last.tolist(), self._largest.tolist(), rms.tolist(), strict=True
            )
        )
