"""Runs one case: what was expected, what the run tells, and what a much finer run says is true."""

from __future__ import annotations

import math
import tempfile
import time
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.error_estimate import estimate, finer_plan
from somo_cli.analysis.level_comparison import LevelRows, compare
from somo_cli.analysis.spooled_run import LevelRunner
from somo_cli.analysis.stability import forecast_of, predicted_error
from somo_cli.analysis.verdict import CONVERGED
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.predict.cases import Case

FINER = 8  # the true run, at this part of the step
NEGLIGIBLE = 1e-5  # of the scale of a column: an error as small is not judged
UNCONVERGED = 0.3  # of the scale: two runs as far apart are two outcomes, and neither is true


@dataclass(frozen=True, slots=True)
class Told:
    """The errors of a case, over the scales of its columns; nan where there is none.

    `told` and `true` have one number for each family of columns that is judged. `expected` is of
    the tip over the length, before the run.
    """

    name: str
    has_contact: bool
    end: str
    told: tuple[float, ...] = ()
    true: tuple[float, ...] = ()
    expected: float = math.nan

    @property
    def is_told_converged(self) -> bool:
        """Whether no error is told to be above 1 % of its range."""
        return bool(self.told) and max(self.told) <= CONVERGED

    @property
    def is_elsewhere(self) -> bool:
        """Whether the true run has another outcome."""
        return bool(self.true) and max(self.true) >= UNCONVERGED

    @property
    def ratios(self) -> tuple[float, ...]:
        """Told over true, of what is worth judging and has one outcome."""
        return tuple(
            told / true
            for told, true in zip(self.told, self.true, strict=True)
            if NEGLIGIBLE < true < UNCONVERGED
        )


def judged(case: Case) -> Told:
    """Return the errors of a case."""
    plan = make_plan(case.scene)
    try:
        told, true = _errors(plan, case.steps)
    except SimulationDiverged:
        return Told(case.name, plan.can_touch, "diverged")
    forecasts = [forecast_of(plan, body) for body in plan.bodies]
    expected = (
        predicted_error(forecasts, plan.integrator, plan.time_step) if forecasts else math.nan
    )
    return Told(case.name, plan.can_touch, "done", told, true, expected)


def _errors(plan: Plan, steps: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the worst relative error of each family: as told, and as it is."""
    runner = LevelRunner(BulletWorld, time.perf_counter, tempfile.TemporaryFile)
    with tempfile.TemporaryFile() as own_file, tempfile.TemporaryFile() as fine_file:
        own = runner.run(plan, steps, own_file)
        told = estimate(plan, own.reader, steps, runner).errors
        fine = runner.run(finer_plan(plan, FINER), FINER * steps, fine_file)
        found, _ = compare(plan, [LevelRows(own.reader()), LevelRows(fine.reader())], (0, 1))
    if found is None:
        return (), ()
    families: dict[tuple[str, str, float], tuple[float, float]] = {}
    for one, true in zip(told, np.asarray(found.judged).tolist(), strict=True):
        if one.scale > 0:
            key = one.name.split(".")[0], one.unit, one.scale
            before = families.get(key, (0.0, 0.0))
            families[key] = max(before[0], one.relative), max(before[1], true / one.scale)
    return tuple(a for a, _ in families.values()), tuple(b for _, b in families.values())
