"""The error of a run, estimated column by column from the same scene at half the step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from somo_cli.analysis.errors import Error
from somo_cli.analysis.trial import Clock, OpenWorld
from somo_cli.arrays import Array
from somo_cli.simulation import columns
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.run import run
from somo_cli.simulation.scene import Integrator

ORDER: dict[Integrator, int] = {"implicit": 2, "euler": 1, "explicit": 1}
"""The order in which the error of an integrator falls with the step."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """The estimated error of every column but the time, and the time that the second run took [s].

    That is the error of the run itself, not of the finer one.
    """

    order: int
    errors: tuple[Error, ...]
    run_time: float


def estimate(
    plan: Plan,
    rows: Callable[[int], Array],
    steps: int,
    open_world: OpenWorld,
    clock: Clock,
    advance: Callable[[int], None] = lambda done: None,
) -> Estimate:
    """Run a plan again at half the step and compare it with its rows; `rows(n)` gives the next n.

    With p the order of the integrator, y(h) - y(h/2) is the error of y(h) times 1 - 2^-p:
    Richardson, Phil. Trans. R. Soc. A 226 (1927) 299. Raises SimulationDiverged and EngineRefused.
    """
    order = ORDER[plan.integrator]
    gauge = _Gauge(plan, rows, 1 / (1 - 2.0**-order))
    # without the conditions that may have ended it: both end with the same instant
    half = replace(plan, time_step=plan.time_step / 2, every=plan.every * 2, stops=())
    with open_world(half) as world:
        taken = run(half, world, gauge.compare, 2 * steps, clock, advance).wall_time
    return Estimate(order, gauge.errors(), taken)


class _Gauge:
    """Takes the rows of the finer run, and holds each against its counterpart."""

    def __init__(self, plan: Plan, rows: Callable[[int], Array], factor: float) -> None:
        self._turns = [list(turn) for turn in columns.turns(plan)]
        self._rows = rows
        self._factor = factor
        width = len(columns.header(plan)) - 1
        self._last: Array = np.zeros(width)
        self._most: Array = np.zeros(width)
        self._squares: Array = np.zeros(width)
        self._count = 0

    def compare(self, fine: Array) -> None:
        coarse = self._rows(len(fine)).copy()
        for turn in self._turns:
            is_other = np.sum(coarse[:, turn] * fine[:, turn], axis=1) < 0  # q and -q are one turn
            coarse[np.ix_(is_other, turn)] *= -1
        difference = self._factor * np.abs(coarse - fine)[:, 1:]
        self._last = difference[-1]
        self._most = np.maximum(self._most, difference.max(axis=0))
        self._squares += np.sum(difference**2, axis=0)
        self._count += len(fine)

    def errors(self) -> tuple[Error, ...]:
        rms = np.sqrt(self._squares / max(1, self._count))
        return tuple(
            Error(final, most, mean)
            for final, most, mean in zip(
                self._last.tolist(), self._most.tolist(), rms.tolist(), strict=True
            )
        )
