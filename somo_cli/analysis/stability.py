"""What to expect of a scene before it runs: modes at its poses, steps that hold, steps that do."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.modes import Modes, modes_at
from somo_cli.analysis.prediction import LARGEST, Motion, motion_of
from somo_cli.arrays import Array
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.loads import stiffness_of
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.scene import Integrator

TARGET = 0.01  # error of the tip relative to the length that a recommended step stays below
SAFETY = 0.9  # of the explicit limit


@dataclass(frozen=True, slots=True)
class Outlook:
    """One body before the run: its modes at the poses looked at, and how it will move.

    The poses are called start, neutral (every spring relaxed) and worst (of a trajectory: where
    the explicit step is least).
    """

    body: Body
    modes: dict[str, Modes]
    motion: Motion

    @property
    def explicit_step(self) -> float:
        """The largest stable step of the explicit law [s] at every pose looked at."""
        return min(one.explicit_step for one in self.modes.values())

    def recommended(self, integrator: Integrator, target: float = TARGET) -> float:
        """Return the step [s] that is stable and whose tip error is expected below the target."""
        step = self.motion.recommended(integrator, target)
        if integrator == "explicit":
            step = min(step, rounded_down(SAFETY * self.explicit_step))
        return step


def outlook_of(plan: Plan, body: Body, met: Iterable[tuple[Pose, Array]] = ()) -> Outlook:
    """Return what to expect of one body of a plan.

    `met` holds poses of the base in the world [engine units] and joint angles, shape (n,), of a
    trajectory. Raises NotAnInertia.
    """
    chain = ChainDynamics(body.chain)
    base = body.start.pose
    start = chain.at(body.start.angles, base)
    modes = {
        "start": _modes(plan, body, start),
        "neutral": _modes(plan, body, chain.at(chain.neutral, base)),
    }
    motion = motion_of(plan, body, start, modes["start"])
    worst = min(
        (_modes(plan, body, chain.at(angles, at)) for at, angles in met),
        key=lambda one: one.explicit_step,
        default=None,
    )
    if worst is not None:
        modes["worst"] = worst
    return Outlook(body, modes, motion)


def recommended_step(plan: Plan, target: float = TARGET) -> tuple[float, float]:
    """Return the step [s] for the integrator of a plan, and the tip error to expect of it.

    The step is the smallest that one of the bodies needs, the error relative to the length that
    of the worst. Raises NotAnInertia.
    """
    outlooks = [outlook_of(plan, body) for body in plan.bodies]
    step = min(one.recommended(plan.integrator, target) for one in outlooks)
    return step, predicted_error(outlooks, plan.integrator, step)


def predicted_error(outlooks: Sequence[Outlook], integrator: Integrator, step: float) -> float:
    """Return the tip error to expect of the worst body, relative to its length."""
    return max(one.motion.error(integrator, step) for one in outlooks)


def _modes(plan: Plan, body: Body, pose: ChainPose) -> Modes:
    geometric = np.zeros((pose.chain.count, pose.chain.count))
    if body.base != "free":
        geometric += pose.gravity_stiffness(plan.gravity)
    for load in body.loads:
        factors = [piece[0] for piece in load.signal.pieces]
        geometric += stiffness_of(load, pose, max(factors, key=abs))
    return modes_at(pose, body.base == "free", geometric)


def rounded_down(step: float) -> float:
    """Return the largest 1, 2 or 5 times a power of ten that is no larger."""
    if not step < LARGEST:
        return LARGEST
    exponent = math.floor(math.log10(step))
    fits = [float(f"{digit}e{exponent}") for digit in (1, 2, 5)]
    return max((one for one in fits if one <= step), default=float(f"5e{exponent - 1}"))
