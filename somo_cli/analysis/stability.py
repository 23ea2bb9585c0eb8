"""What to expect of a scene before it runs: modes at its poses, steps that hold, steps that do."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.modes import Modes, modes_at
from somo_cli.analysis.prediction import LARGEST_STEP, ModalMotion, predict_motion
from somo_cli.arrays import Array
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.model import Integrator
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.dynamics.external_loads import load_stiffness
from somo_cli.simulation.plan.model import Body, Plan

TARGET_TIP_ERROR = (
    0.01  # error of the tip relative to the length that a recommended step stays below
)
EXPLICIT_SAFETY = 0.9  # of the explicit limit


@dataclass(frozen=True, slots=True)
class StabilityForecast:
    """One body before the run: its modes at the poses looked at, and how it will move.

    The poses are called start, neutral (every spring relaxed) and worst (of a trajectory: where
    the explicit step is least).
    """

    body: Body
    modes: dict[str, Modes]
    motion: ModalMotion

    @property
    def explicit_step(self) -> float:
        """The largest stable step of the explicit law [s] at every pose looked at."""
        return min(one.explicit_step for one in self.modes.values())

    def recommended_step_for(
        self, integrator: Integrator, target: float = TARGET_TIP_ERROR
    ) -> float:
        """Return the step [s] that is stable and whose tip error is expected below the target."""
        step = self.motion.recommended_step_for(integrator, target)
        if integrator == "explicit":
            step = min(step, round_down_step(EXPLICIT_SAFETY * self.explicit_step))
        return step


def forecast_of(
    plan: Plan, body: Body, visited: Iterable[tuple[Pose, Array]] = ()
) -> StabilityForecast:
    """Return what to expect of one body of a plan.

    `visited` holds poses of the base in the world [engine units] and joint angles, shape (n,), of a
    trajectory. Raises SingularInertia.
    """
    chain = ChainDynamics(body.chain)
    base = body.start.pose
    start = chain.at(body.start.angles, base)
    modes = {
        "start": _modes(plan, body, start),
        "neutral": _modes(plan, body, chain.at(chain.neutral, base)),
    }
    motion = predict_motion(plan, body, start, modes["start"])
    worst = min(
        (_modes(plan, body, chain.at(angles, at)) for at, angles in visited),
        key=lambda one: one.explicit_step,
        default=None,
    )
    if worst is not None:
        modes["worst"] = worst
    return StabilityForecast(body, modes, motion)


def recommended_step(plan: Plan, target: float = TARGET_TIP_ERROR) -> tuple[float, float]:
    """Return the step [s] for the integrator of a plan, and the tip error to expect of it.

    The step is the smallest that one of the bodies needs, the error relative to the length that
    of the worst. Raises SingularInertia.
    """
    forecasts = [forecast_of(plan, body) for body in plan.bodies]
    step = min(one.recommended_step_for(plan.integrator, target) for one in forecasts)
    return step, predicted_error(forecasts, plan.integrator, step)


def predicted_error(
    forecasts: Sequence[StabilityForecast], integrator: Integrator, step: float
) -> float:
    """Return the tip error to expect of the worst body, relative to its length."""
    return max(one.motion.error(integrator, step) for one in forecasts)


def _modes(plan: Plan, body: Body, pose: ChainPose) -> Modes:
    geometric = np.zeros((pose.chain.count, pose.chain.count))
    if body.base != "free":
        geometric += pose.gravity_stiffness(plan.gravity)
    for load in body.loads:
        factors = [piece[0] for piece in load.signal.pieces]
        geometric += load_stiffness(load, pose, max(factors, key=abs))
    return modes_at(pose, body.base == "free", geometric)


def round_down_step(step: float) -> float:
    """Return the largest 1, 2 or 5 times a power of ten that is no larger."""
    if not step < LARGEST_STEP:
        return LARGEST_STEP
    exponent = math.floor(math.log10(step))
    fits = [float(f"{digit}e{exponent}") for digit in (1, 2, 5)]
    return max((one for one in fits if one <= step), default=float(f"5e{exponent - 1}"))
