"""Whether a free base turns faster than the engine can follow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.monitoring.object_motion import MAX_ANGLE_PER_STEP
from somo_cli.simulation.plan.model import Body, Plan


class TurningBody(Protocol):
    """What is asked of one body."""

    @property
    def body(self) -> Body:
        """The body, as planned."""

    @property
    def base_rate(self) -> float:
        """The angular velocity of its base [rad/s] if nothing holds that, else 0."""


def check_bases(step: int, plan: Plan, bodies: Sequence[TurningBody]) -> None:
    """Raise SimulationDiverged if a free base turns by more than MAX_ANGLE_PER_STEP in a step.

    The engine turns it by less than it should then, and its rotation has no solution. NaN counts
    as too far.
    """
    for one in bodies:
        angle = one.base_rate * plan.time_step
        if not angle < MAX_ANGLE_PER_STEP:
            reason = f"its base turns {angle:.3g} rad in one step"
            hint = f"try half the step, --time-step {plan.time_step / 2:g}"
            raise SimulationDiverged(
                step, step * plan.time_step, one.body.name, reason, hint, "manipulator"
            )
