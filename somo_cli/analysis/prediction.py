"""Expected error of the tip for a time step, from the modes at the start, without a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.modal_excitation import sideways_release, vibration
from somo_cli.analysis.modes import Modes
from somo_cli.analysis.round_steps import LARGEST_STEP
from somo_cli.arrays import Array
from somo_cli.scene.model import Integrator
from somo_cli.simulation.dynamics.chain_dynamics import ChainPose
from somo_cli.simulation.plan.model import Body, Plan

HORIZON = 5.0  # s, over which errors of lightly damped modes grow
STEP_DIGITS = (1.0, 2.0, 5.0)  # times a power of ten
MAX_TIP_TRAVEL = 2.0  # lengths that a tip can move from its start


@dataclass(frozen=True, slots=True)
class ModalMotion:
    """The motion of the tip in each mode, arrays of shape (n,), slow modes first.

    `amplitudes` [engine length] are those of free vibration about static equilibrium, and
    `phase_weighted` the same times the phase angle (see `Vibration`); `rates` [rad/s] are the
    moduli of the roots. `spring_shares` are the shares of springs in the modal stiffness; gravity
    and loads are the rest. `length` is that of the chain; `travel` is the distance, in lengths,
    that a free base carries the chain, rotation included. `joint_amplitudes` [rad], shape (n, n),
    are those of each joint (row) in each mode (column); `bend` [rad] is the largest of all joints.
    `is_assumed` says that nothing moves the body, and that a sideways release was assumed.
    """

    amplitudes: Array
    phase_weighted: Array
    rates: Array
    spring_shares: Array
    length: float
    travel: float
    joint_amplitudes: Array
    bend: float
    is_free: bool
    is_assumed: bool

    @property
    def joint_excursions(self) -> Array:
        """Upper bound on the distance of each joint from its start [rad], shape (n,).

        It is twice the amplitude: a released mode swings past equilibrium by as much again.
        """
        bound: Array = 2 * self.joint_amplitudes.sum(axis=1)
        return bound

    def largest_turn(self, step: float) -> float:
        """Return the largest rotation of a joint in one step [rad].

        Each mode contributes its rate times its amplitude; a mode that the step does not resolve
        contributes its amplitude.
        """
        return float((self.joint_amplitudes @ np.minimum(1.0, step * self.rates)).max())

    def error(self, integrator: Integrator, step: float) -> float:
        """Return the expected tip error for a step [s], relative to the length.

        The step changes the root of each mode, which causes an error of `phase_weighted` times the
        relative change, and it changes the amplitude. For a mode that the step does not resolve,
        the error is its whole amplitude. The errors of all modes are added: the worst case.
        """
        at_once, in_root = STEP_ERRORS[integrator](step * self.rates, self)
        lost = np.minimum(
            self.amplitudes, self.amplitudes * at_once + self.phase_weighted * in_root
        )
        # momentum errors of the modes move a free base; with backward Euler the errors of the
        # modes themselves are larger than that
        of_base = (
            FREE_BASE_FACTOR * (1 + self.travel)
            if self.is_free and integrator == "implicit"
            else 1.0
        )
        return float(lost.sum()) / self.length * of_base

    def recommended_step_for(self, integrator: Integrator, target: float) -> float:
        """Return the largest step [s] of 1, 2 or 5 times a power of ten that meets a target.

        `target` is the expected tip error relative to the length.
        """
        for exponent in range(-2, -9, -1):
            for digit in reversed(STEP_DIGITS):
                step = float(f"{digit:g}e{exponent}")
                if step <= LARGEST_STEP and self.error(integrator, step) <= target:
                    return step
        return float(f"{STEP_DIGITS[0]:g}e-8")


def _second_order(h_rate: Array, motion: ModalMotion) -> tuple[Array, Array]:
    # springs are followed to fourth order; gravity and loads as by leapfrog, with an error of
    # (h ω)²/24, and so are Coriolis forces, which grow with the square of the angles
    others = np.abs(1 - motion.spring_shares) / 24 + CORIOLIS_FACTOR * motion.bend**2
    return AMPLITUDE_ERROR["implicit"] * h_rate**2, h_rate**2 * others + h_rate**4 / 240


def _first_order(h_rate: Array, motion: ModalMotion) -> tuple[Array, Array]:
    # backward Euler adds a damping of h K / 2 with the stiffness K of the springs alone
    return AMPLITUDE_ERROR["euler"] * h_rate, 0.5 * h_rate * np.abs(motion.spring_shares)


def _symplectic(h_rate: Array, motion: ModalMotion) -> tuple[Array, Array]:
    # symplectic Euler: a first-order error of the initial state, a second-order error of phase
    return 0.5 * h_rate, h_rate**2 / 24


STEP_ERRORS = {"implicit": _second_order, "euler": _first_order, "explicit": _symplectic}

AMPLITUDE_ERROR = {"implicit": 0.12, "euler": 0.8}
CORIOLIS_FACTOR = 0.03
FREE_BASE_FACTOR = 3.0
"""Four factors that are fitted to runs; theory gives all others.

The ratio of predicted to true error is judged for true errors between 1e-4 and 5e-2 of the length
(tests/analysis/test_prediction.py). In the 67 runs of the fitted scenes no prediction is more than
1 % too small, the median ratio is 2.1, 70 % are below 3, and the largest is 18 (backward Euler, a
free snake). In 48 runs of random scenes, which were not fitted, the median is 1.7; 83 % are within
a factor of 3, and the largest is 10; 6 % are too small by more than a third, at most by a factor of
2. In the worst of two other random samples it was 11 % of 70, at most by a factor of 3: free bodies
and stiff ones. Chains that topple are not included.
"""


def predict_motion(
    plan: Plan, body: Body, pose: ChainPose, modes: Modes, horizon: float = HORIZON
) -> ModalMotion:
    """Return the motion of a body from its start at this pose over `horizon` [s], by its modes.

    The modes do not describe a chain that topples, and describe one that bends by more than a
    radian a joint poorly. A body that nothing moves is assumed to be released in gravity of
    9.81 m/s² sideways.
    """
    chain, length = pose.chain, body.chain.length
    # an assembly has several tips: each mode counts by the one that it moves most
    tips = np.max(
        [np.linalg.norm(one @ modes.shapes, axis=0) for one in pose.tip_jacobians()], axis=0
    )
    found = vibration(body, pose, modes, plan.gravity, horizon)
    swings = found.largest
    is_assumed = float(tips @ swings) <= 1e-12 * length
    if is_assumed:
        found = sideways_release(body, pose, modes, 9.81 * plan.scale.length, horizon)
    with np.errstate(divide="ignore"):
        within = np.minimum(1.0, MAX_TIP_TRAVEL * length / (tips * found.largest))
    springs = np.einsum("jk,j,jk->k", modes.shapes, chain.stiffness, modes.shapes)
    speed, spin = map(np.linalg.norm, (body.start.linear_velocity, body.start.angular_velocity))
    travel = float(speed / length + spin) * horizon if body.base == "free" else 0.0
    return ModalMotion(
        amplitudes=within * tips * found.largest,
        phase_weighted=within * tips * found.phase_weighted,
        rates=np.abs(modes.roots),
        spring_shares=springs / modes.moduli**2,
        length=length,
        travel=travel,
        joint_amplitudes=np.abs(modes.shapes) * swings,
        bend=float((np.abs(modes.shapes) @ found.largest).max()),
        is_free=body.base == "free",
        is_assumed=is_assumed,
    )
