"""Forecast of a scene before it runs: modes, stable time steps, and recommended ones."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.contact_step import contact_step
from somo_cli.analysis.modes import Modes, modes_at
from somo_cli.analysis.prediction import ModalMotion, predict_motion
from somo_cli.analysis.round_steps import round_down_step
from somo_cli.arrays import Array
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.model import Integrator
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.dynamics.external_loads import load_stiffness
from somo_cli.simulation.plan.model import Body, Plan

TARGET_TIP_ERROR = 0.01  # of a recommended step, relative to the length
EXPLICIT_SAFETY = 0.9  # of the largest stable step of the explicit integrator


@dataclass(frozen=True, slots=True)
class StabilityForecast:
    """The modes of a body at several poses, by name, and its expected motion.

    The poses are start, neutral (all springs relaxed) and worst (the pose of a trajectory with the
    smallest explicit step).
    """

    body: Body
    modes: dict[str, Modes]
    motion: ModalMotion

    @property
    def explicit_step(self) -> float:
        """The largest step of the explicit integrator that is stable at all poses [s]."""
        return min(one.explicit_step for one in self.modes.values())

    def recommended_step_for(
        self, integrator: Integrator, target: float = TARGET_TIP_ERROR
    ) -> float:
        """Return the largest stable step [s] with an expected tip error below the target."""
        step = self.motion.recommended_step_for(integrator, target)
        if integrator == "explicit":
            step = min(step, round_down_step(EXPLICIT_SAFETY * self.explicit_step))
        return step


def forecast_of(
    plan: Plan, body: Body, visited: Iterable[tuple[Pose, Array]] = ()
) -> StabilityForecast:
    """Return the forecast of a body of a plan.

    `visited` holds base poses in the world [engine units] and joint angles [rad], shape (n,), of a
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
    """Return the recommended step [s] for the integrator of a plan, and its expected tip error.

    The step is the smallest of all bodies, and that of contact if they can touch; the error is the
    largest in free motion, relative to the length. Raises SingularInertia.
    """
    forecasts = [forecast_of(plan, body) for body in plan.bodies]
    step = min(one.recommended_step_for(plan.integrator, target) for one in forecasts)
    step = min(step, contact_step(plan))
    return step, predicted_error(forecasts, plan.integrator, step)


def predicted_error(
    forecasts: Sequence[StabilityForecast], integrator: Integrator, step: float
) -> float:
    """Return the largest expected tip error of the bodies, relative to their lengths."""
    return max(one.motion.error(integrator, step) for one in forecasts)


def _modes(plan: Plan, body: Body, pose: ChainPose) -> Modes:
    geometric = np.zeros((pose.chain.count, pose.chain.count))
    if body.base != "free":
        geometric += pose.gravity_stiffness(plan.gravity)
    for load in body.loads:
        factors = [piece[0] for piece in load.signal.pieces]
        geometric += load_stiffness(load, pose, max(factors, key=abs))
    return modes_at(pose, body.base == "free", geometric)
