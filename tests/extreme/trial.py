"""One case run by one integrator, and what came of it."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.problems import EngineRefused, SimulationDiverged
from somo_cli.scene.model import Integrator
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.model import Plan
from tests.builders.momentum import momentum
from tests.extreme.case import Case
from tests.extreme.statics import equilibrium, slowest_decay

ROWS = 50
DECAYS = 25.0  # time constants after which nothing but rounding is left
AT_REST = 1e-7  # rad
TOO_FAST = 1.0  # rad in one step: no method of steps this long follows such a motion
FIRST = 50  # steps in which a run that errs grossly is asked for it
FINER = 64  # steps in a step, where the true motion is asked for
SHOWN_GAIN = 0.02  # of the energy exchanged
GAIN = 0.2  # likewise: a whip that nears TOO_FAST may win as much for a while
LOSS = 0.2  # of a momentum


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one run.

    `diverged` is the step of divergence. Where it diverged or erred grossly, `is_too_fast` says
    whether the true motion turns a joint by more than TOO_FAST in one step. `apart` [rad] is how
    far the joints are from equilibrium at the end, `is_due` whether they should long be there.
    `gain` is the most by which the energy of a passive body exceeded that of its start, `lost` the
    change of momentum, both relative to what was exchanged. None where it does not apply.
    """

    diverged: int | None = None
    is_too_fast: bool = False
    refused: str | None = None
    apart: float | None = None
    is_due: bool = False
    gain: float | None = None
    lost: float | None = None

    @property
    def is_stable(self) -> bool:
        """Whether it ran to its end."""
        return self.diverged is None and self.refused is None

    @property
    def is_restless(self) -> bool:
        """Whether it should be at rest and is not."""
        return self.is_due and not (self.apart is not None and self.apart < AT_REST)

    @property
    def is_creative(self) -> bool:
        """Whether it has won more energy, or changed its momentum by more, than errors explain."""
        wins = self.gain is not None and not self.gain < GAIN
        return wins or (self.lost is not None and not self.lost < LOSS)


def outcome(case: Case, integrator: Integrator) -> Outcome:
    """Run a case and rate it."""
    steps = case.steps
    plan = case.plan(integrator, case.time_step, max(1, steps // ROWS))
    blocks: list[Array] = []
    try:
        with BulletWorld(plan) as world:
            before = momentum(world, plan)
            run.run(plan, world, blocks.append, steps, lambda: 0.0)
            after = momentum(world, plan)
    except SimulationDiverged as error:
        is_too_fast = integrator != "explicit" and _is_too_fast(case, error.step)
        return Outcome(diverged=error.step, is_too_fast=is_too_fast)
    except EngineRefused as error:
        return Outcome(refused=str(error))
    table = np.concatenate(blocks)
    n = case.joints
    angles, energies = table[:, 1 : 1 + n], table[:, 1 + n :]
    apart, is_due = _rest(case, plan, angles[-1])
    found = Outcome(
        apart=apart,
        is_due=is_due,
        gain=_gain(energies) if case.is_passive else None,
        lost=_lost(plan, before, after, energies) if case.keeps_momentum else None,
    )
    if found.is_creative and integrator != "explicit":
        return dataclasses.replace(found, is_too_fast=_is_too_fast(case, min(steps, FIRST)))
    return found


def _is_too_fast(case: Case, steps: int) -> bool:
    """Whether a joint turns by more than TOO_FAST in a step, as much finer steps have it."""
    plan = case.plan("implicit", case.time_step / FINER, 1)
    plan = dataclasses.replace(plan, columns=("joint_rates",))
    fastest = 0.0

    def sample(block: Array) -> None:
        nonlocal fastest
        fastest = max(fastest, float(np.abs(block[:, 1:]).max()))

    try:
        with BulletWorld(plan) as world:
            run.run(plan, world, sample, (steps + 1) * FINER, lambda: 0.0)
    except SimulationDiverged:
        pass
    return fastest * case.time_step > TOO_FAST


def _rest(case: Case, plan: Plan, angles: Array) -> tuple[float | None, bool]:
    # what the base loses in momentum it turns by, and the joints feel that
    if not case.is_damped or case.base == "free":
        return None, False
    pose = equilibrium(plan, angles)
    if pose is None or not np.abs(pose.angles).max() < case.limit:
        return None, False
    is_due = slowest_decay(plan, pose) * case.time_step * case.steps > DECAYS
    return float(np.abs(angles - pose.angles).max()), is_due


def _gain(energies: Array) -> float:
    total = energies.sum(axis=1)
    exchanged = float(np.ptp(energies, axis=0).max())
    return float((total - total[0]).max()) / exchanged if exchanged > 0 else 0.0


def _lost(
    plan: Plan, before: tuple[Array, Array], after: tuple[Array, Array], energies: Array
) -> float:
    """Return the larger change of both momenta, relative to those of the largest energy."""
    (body,) = plan.bodies
    mass = sum(link.inertial.mass for link in body.chain.links)
    # released from rest, and damped, it has less kinetic energy in the rows than it had between
    energy = float(np.ptp(energies, axis=0).max() + energies[0, 0])
    linear = math.sqrt(2 * mass * energy * plan.scale.mass) * plan.scale.length
    sizes = (linear, linear * body.chain.length)
    changes = (np.linalg.norm(b - a) for a, b in zip(before, after, strict=True))
    return max(float(change) / size for change, size in zip(changes, sizes, strict=True))
