"""One case run by one integrator, and what came of it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from somo_cli.problems import EngineRefused, SimulationDiverged
from somo_cli.simulation import run
from somo_cli.simulation.bullet import BulletWorld
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.scene import Integrator
from somo_cli.simulation.springs import Array
from tests.extreme.case import Case
from tests.extreme.statics import equilibrium, slowest_decay
from tests.simulation.test_physics import momentum

ROWS = 50
DECAYS = 25.0  # time constants after which nothing but rounding is left
AT_REST = 1e-7  # rad
GAIN = 0.02  # of the energy exchanged: what second order may add for a while


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one run.

    `diverged` is the step of divergence. `apart` [rad] is how far the joints are from equilibrium
    at the end, `is_due` whether they should long be there. `gain` is the most by which the energy
    of a passive body exceeded that of its start, `lost` the change of momentum, both relative to
    what was exchanged. None where it does not apply.
    """

    diverged: int | None = None
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
    def gains(self) -> bool:
        """Whether it has won energy."""
        return self.gain is not None and not self.gain < GAIN


def outcome(case: Case, integrator: Integrator) -> Outcome:
    """Run a case and judge it."""
    steps = case.steps
    plan = case.plan(integrator, case.time_step, max(1, steps // ROWS))
    rows: list[list[float]] = []

    def keep(values: Iterable[float]) -> None:
        rows.append(list(values))

    try:
        with BulletWorld(plan) as world:
            before = momentum(world, plan)
            run.run(plan, world, keep, steps, lambda: 0.0)
            after = momentum(world, plan)
    except SimulationDiverged as error:
        return Outcome(diverged=error.step)
    except EngineRefused as error:
        return Outcome(refused=str(error))
    table = np.array(rows)
    n = case.joints
    angles, energies = table[:, 1 : 1 + n], table[:, 1 + n :]
    apart, is_due = _rest(case, plan, angles[-1])
    return Outcome(
        apart=apart,
        is_due=is_due,
        gain=_gain(energies) if case.is_passive else None,
        lost=_lost(plan, before, after, energies) if case.keeps_momentum else None,
    )


def _rest(case: Case, plan: Plan, angles: Array) -> tuple[float | None, bool]:
    is_turning = case.base == "free" and (any(case.spin) or case.rates != 0)
    if not case.is_damped or is_turning:
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
    kinetic = float(energies[:, 0].max()) * plan.scale.mass * plan.scale.length**2
    linear = math.sqrt(2 * mass * kinetic)
    sizes = (linear, linear * body.chain.length)
    changes = (np.linalg.norm(b - a) for a, b in zip(before, after, strict=True))
    return max(float(change) / size for change, size in zip(changes, sizes, strict=True))
