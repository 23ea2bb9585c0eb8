"""One run of a case: its figure, or how it failed; and its converged value."""

from __future__ import annotations

import dataclasses
import math
import time
from dataclasses import dataclass
from functools import cache

import numpy as np

from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.scene import columns
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.contact.candidates import EXPLICIT, PLAIN, Candidate
from tests.contact.cases import Case, Table, named

BLOCK = 0.02  # s: motion within it is no growth of energy: an impact disturbs what is sampled


@dataclass(frozen=True, slots=True)
class Trial:
    """What a run gave: its figure, not a number if it diverged, and the time of a step [s]."""

    figure: float
    seconds_per_step: float
    growth: float = 0.0
    """How much the energy grew once it had fallen, over what it fell in all; passive cases."""


@dataclass(frozen=True, slots=True)
class Truth:
    """The converged figure, and how far it is known: the last change when the step was halved."""

    figure: float
    spread: float


def recorded(case: Case, step: float, candidate: Candidate = PLAIN) -> tuple[Table, run.RunSummary]:
    """Run a case, and return its columns; raises SimulationDiverged."""
    scene = dataclasses.replace(case.scene(step), integrator=candidate.integrator)
    plan = make_plan(scene)
    blocks: list[Array] = []
    with candidate.installed(), BulletWorld(plan) as world:
        summary = run.run(plan, world, blocks.append, round(case.seconds / step), time.perf_counter)
    return dict(zip(columns.header(plan.recorded), np.concatenate(blocks).T, strict=True)), summary


def trial(case: Case, step: float, candidate: Candidate = PLAIN) -> Trial:
    """Run a case, and return what it gave."""
    try:
        table, summary = recorded(case, step, candidate)
    except SimulationDiverged:
        return Trial(math.nan, math.nan)
    growth = growth_of_energy(table, step) if case.is_passive else 0.0
    return Trial(case.figure(table), summary.wall_time / summary.steps, growth)


def growth_of_energy(table: Table, step: float) -> float:
    """Return by how much the energy grew again, over how much it fell."""
    energy = np.sum([values for name, values in table.items() if name.endswith("_j")], axis=0)
    block = max(1, round(BLOCK / step))
    energy = energy[: len(energy) // block * block].reshape(-1, block).max(axis=1)
    least = np.minimum.accumulate(energy)
    return float((energy - least).max() / (energy[0] - energy.min()))


@cache
def truth(case_name: str) -> Truth:
    """Return the figure that the explicit loop tends to, by its finest step and twice that."""
    case = named(case_name)
    coarse, fine = (trial(case, step, EXPLICIT).figure for step in (2 * case.finest, case.finest))
    return Truth(fine, abs(fine - coarse))
