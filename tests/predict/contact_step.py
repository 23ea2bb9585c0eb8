"""How many times finer the recommended step of contact scenes is than the largest that holds."""

from __future__ import annotations

import dataclasses
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.column_families import QUATERNION_UNIT, ColumnFamily
from somo_cli.analysis.contact_step import contact_step
from somo_cli.analysis.level_comparison import DifferenceAccumulator, common_rows
from somo_cli.analysis.spooled_run import LevelRunner
from somo_cli.analysis.stability import recommended_step
from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.scene import columns
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of
from tests.predict.cases import Case

FACTORS = (8, 4, 2, 1)  # times the recommended step
FINEST = 1 / 4  # of it: what the others are held against
NEXT_FINEST = 1 / 2  # of it: tells whether the scene has an outcome that steps agree on
WITHIN = 0.01  # of the largest range in the unit, or the size of the scene
RADIAN = 1.0  # rad, a turn that is large in every scene


@dataclass(frozen=True, slots=True)
class Rung:
    """A run at a step [s]: what its monitors found, and its worst error over the range."""

    time_step: float
    findings: tuple[str, ...]
    error: float

    @property
    def holds(self) -> bool:
        """Whether it has no finding and is within 1 % of the finest."""
        return not self.findings and self.error <= WITHIN


@dataclass(frozen=True, slots=True)
class Ladder:
    """A scene at 8 times to half its recommended step [s], coarse to fine."""

    name: str
    recommended: float
    rungs: tuple[Rung, ...]

    @property
    def is_settled(self) -> bool:
        """Whether half the recommended step is within 1 % of the finest, or a larger one is."""
        return any(one.error <= WITHIN for one in self.rungs)

    @property
    def times_too_fine(self) -> float:
        """The largest step at which it and all finer ones hold, over the recommended step.

        It is 0.5 or 0 where that itself does not hold.
        """
        found = 0.0
        for one in reversed(self.rungs):
            if not one.holds:
                break
            found = one.time_step / self.recommended
        return found

    @property
    def own(self) -> Rung:
        """The run at the recommended step."""
        return next(one for one in self.rungs if one.time_step == self.recommended)


def recommended(plan: Plan) -> float:
    """Return the step that `time_step: auto` takes [s], or that of contact without joints."""
    return recommended_step(plan)[0] if plan.bodies else contact_step(plan)


def climbed(case: Case) -> Ladder:
    """Return a case at every step of its ladder."""
    plan = dataclasses.replace(make_plan(case.scene), stop_conditions=())
    step = recommended(plan)
    intervals = round(case.duration / (FACTORS[0] * step))
    reference, _ = _run(plan, step, FINEST, intervals)
    rungs = [_rung(plan, step, factor, intervals, reference) for factor in (*FACTORS, NEXT_FINEST)]
    return Ladder(case.name, step, tuple(rungs))


def _rung(plan: Plan, step: float, factor: float, intervals: int, reference: Array) -> Rung:
    try:
        rows, findings = _run(plan, step, factor, intervals)
    except SimulationDiverged:
        return Rung(factor * step, ("diverged",), float("inf"))
    differences = DifferenceAccumulator(plan)
    differences.add(*common_rows([rows, reference]))
    found = differences.differences()
    scales = _scales(plan, differences.families, found.range)
    names = columns.header(plan.recorded)
    worst = max(
        float(found.judged[column - 1]) / scales[family.unit]
        for family in differences.families
        for column in family.columns
        if scales[family.unit] > 0 and not _is_undetermined(names[column], family)
    )
    return Rung(factor * step, findings, worst)


def _is_undetermined(name: str, family: ColumnFamily) -> bool:
    """Whether a column is a force of which friction may hold any share.

    Four fingers around a cube may rub against each other with either sign: no step decides that.
    Normal forces are judged.
    """
    return family.measure == "impulse" and not name.endswith(".normal_n")


def _scales(plan: Plan, families: Sequence[ColumnFamily], ranges: Array) -> dict[str, float]:
    """Return what an error is held against, by the unit.

    It is the largest range in the unit, at least the size of what is simulated and a radian: a ball
    that is held moves by rounding and no more, and is not off by all of its range.
    """
    units = unit_factors_of(plan)
    sizes = [body.chain.length for body in plan.bodies]
    for planned in plan.objects:
        shapes = planned.rigid_object.chain.links[0].shapes
        sizes += [2 * shape.solid.circumradius for shape in shapes]
    found = {"m": max(sizes) / units.length, "rad": RADIAN, QUATERNION_UNIT: RADIAN / 2}
    for family in families:
        size = max(float(ranges[column - 1]) for column in family.columns)
        found[family.unit] = max(found.get(family.unit, 0.0), size)
    return found


def _run(plan: Plan, step: float, factor: float, intervals: int) -> tuple[Array, tuple[str, ...]]:
    """Return the rows at intervals of the coarsest step, with impulses, and the findings."""
    every = round(FACTORS[0] / factor)
    other = dataclasses.replace(plan, time_step=factor * step, every=every)
    with ExitStack() as stack:
        runner = LevelRunner(BulletWorld, time.perf_counter, tempfile.TemporaryFile)
        stream = stack.enter_context(runner.open_file())
        rows = runner.run(other, intervals * every, stream).reader()(intervals + 1)
        assert runner.summary is not None, "the run has ended"
        codes = tuple(one.code for one in runner.summary.findings)
    return np.asarray(rows), codes
