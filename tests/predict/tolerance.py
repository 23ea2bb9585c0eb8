"""What `--tolerance` asks, tells and costs, held against a much finer run."""

from __future__ import annotations

import tempfile
import time
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.error_estimate import finer_plan
from somo_cli.analysis.level_comparison import LevelRows, compare
from somo_cli.analysis.refinement import Refinement, Refiner
from somo_cli.analysis.spooled_run import LevelRunner
from somo_cli.analysis.tolerances import Tolerances
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.predict.cases import Case

ASKED = 1e-2  # of the range of each column
FINER = 4  # the true run, at this part of the finest step
MAX_HALVINGS = 4


@dataclass(frozen=True, slots=True)
class Kept:
    """A run to a tolerance: worst errors over the scales of the columns, as told and as true.

    `time_step` [s] is that of the finest run. `cost` is the run time of all runs over that of the
    scene at its own step.
    """

    name: str
    has_contact: bool
    end: str
    time_step: float = 0.0
    told: float = 0.0
    true: float = 0.0
    cost: float = 0.0


def kept(case: Case, asked: float = ASKED) -> Kept:
    """Return what a run of a case to a tolerance told, and what is true."""
    plan = make_plan(case.scene)
    with ExitStack() as stack:
        runner = LevelRunner(BulletWorld, time.perf_counter, tempfile.TemporaryFile)
        refiner = Refiner(plan, case.steps, Tolerances(asked), runner, stack, MAX_HALVINGS)
        try:
            found = refiner.refine()
            true = _true_error(found, case.steps * 2**found.halvings, runner, stack)
        except SimulationDiverged:
            return Kept(case.name, plan.can_touch, "diverged")
    own = next((one for one in found.levels if one.time_step == plan.time_step), found.levels[-1])
    return Kept(
        case.name,
        plan.can_touch,
        "converged" if found.is_converged else "NOT converged",
        found.plan.time_step,
        max(one.relative for one in found.errors),
        true,
        found.run_time / own.run_time,
    )


def _true_error(found: Refinement, steps: int, runner: LevelRunner, stack: ExitStack) -> float:
    """Return the worst error of the finest run over the scales that it told."""
    stream = stack.enter_context(runner.open_file())
    fine = runner.run(finer_plan(found.plan, FINER), FINER * steps, stream)
    levels = [LevelRows(found.rows.reader()), LevelRows(fine.reader())]
    differences, _ = compare(found.plan, levels, (0, 1))
    assert differences is not None, "a case has rows beside the start"
    scales = np.array([one.scale for one in found.errors])
    return float(np.max(differences.judged[scales > 0] / scales[scales > 0]))
