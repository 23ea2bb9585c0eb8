"""A run whose step is halved until its columns are known well enough, in memory."""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from somo_cli import files
from somo_cli.analysis import refinement_report
from somo_cli.analysis.refinement import MAX_HALVINGS, Refiner
from somo_cli.analysis.spooled_run import LevelRunner
from somo_cli.analysis.tolerances import Tolerances, tolerances
from somo_cli.api.result import Result
from somo_cli.arrays import Array
from somo_cli.simulation.engine.bullet.world import BulletWorld

if TYPE_CHECKING:
    from somo_cli.api.runs import PreparedRun

Tolerance: TypeAlias = "float | Mapping[str, float]"
"""A share of the range of every column, or values in their units by patterns of column names."""


def refined(prepared: PreparedRun, steps: int, tolerance: Tolerance) -> Result:
    """Return what the finest run records, with its errors in the metadata.

    Warns if it is not within the tolerance. Raises ValueError for a tolerance that is none, and
    SimulationDiverged if the finest run diverges.
    """
    allowed = _tolerances(tolerance, prepared.names[1:])
    with ExitStack() as stack:
        runner = LevelRunner(BulletWorld, time.perf_counter, files.temporary_file)
        found = Refiner(prepared.plan, steps, allowed, runner, stack, MAX_HALVINGS).refine()
        blocks: list[Array] = []
        found.rows.write_to(blocks.append)
    about = {
        **replace(prepared, plan=found.plan).metadata(found.summary),
        "error": refinement_report.plain_error(found),
        "refinement": refinement_report.plain_refinement(found),
    }
    if not found.is_converged:
        warnings.warn(refinement_report.verdict(found), RuntimeWarning, stacklevel=3)
    return Result(prepared.names, np.concatenate(blocks), about)


def _tolerances(tolerance: Tolerance, names: tuple[str, ...]) -> Tolerances:
    if isinstance(tolerance, Mapping):
        return tolerances(None, tolerance, names)
    return tolerances(tolerance, {}, names)
