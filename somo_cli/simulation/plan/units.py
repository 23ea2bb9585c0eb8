"""The factors from SI to the engine's units that rows and stop conditions need."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.manipulator.dimensions import Dimension
from somo_cli.simulation.plan.model import Plan

TORQUE = Dimension(mass=1, length=2, time=-2)


@dataclass(frozen=True, slots=True)
class UnitFactors:
    """Engine units per SI unit."""

    length: float
    torque: float
    force: float


def unit_factors_of(plan: Plan) -> UnitFactors:
    """Return the factors that convert SI values to the engine units of a plan."""
    force = plan.scale.factor(Dimension(mass=1, length=1, time=-2))
    return UnitFactors(plan.scale.factor(Dimension(length=1)), plan.scale.factor(TORQUE), force)
