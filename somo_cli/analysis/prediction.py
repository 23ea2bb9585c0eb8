"""What error of the tip to expect from a step, without running: by the modes at the start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.modal_excitation import sideways_release, vibration
from somo_cli.analysis.modes import Modes
from somo_cli.arrays import Array
from somo_cli.scene.model import Integrator
from somo_cli.simulation.dynamics.chain_dynamics import ChainPose
from somo_cli.simulation.plan.model import Body, Plan

HORIZON = 5.0  # s: for how long an error may grow in what is hardly damped
LARGEST_STEP = 0.05  # s: no longer step is ever recommended
STEP_DIGITS = (1.0, 2.0, 5.0)  # times a power of ten
MAX_TIP_TRAVEL = 2.0  # lengths: no tip moves farther from where it started


@dataclass(frozen=True, slots=True)
class ModalMotion:
    """How each mode moves the tip, one number a mode, shape (n,); slow modes first.

    `amplitudes` [engine length] are those of free vibration about the static part, `phase_weighted`
    the same times the angle that the mode turns by meanwhile (see `Vibration`), `rates` [rad/s] the
    moduli of their roots. `spring_shares` is what of a mode's stiffness is springs; the rest is
    gravity and loads. `length` is the chain's; `travel` is how far a free base carries it in the
    meantime, turning included, in lengths. `turns` [rad], shape (n, n), holds by how much each
    joint, one a row, turns in each mode; `bend` [rad] is the amplitude of the one that swings
    most. Where nothing moves the body, `is_assumed` says that it was taken to be let go sideways.
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
        """A bound on how far each joint goes from its start [rad], shape (n,).

        Twice the amplitudes: a mode that is let go swings past its rest by as much again.
        """
        bound: Array = 2 * self.joint_amplitudes.sum(axis=1)
        return bound

    def largest_turn(self, step: float) -> float:
        """Return the most that a joint may turn in one step [rad].

        By the rate of each mode times its amplitude; a mode that is not resolved turns by its
        amplitude at once.
        """
        return float((self.joint_amplitudes @ np.minimum(1.0, step * self.rates)).max())

    def error(self, integrator: Integrator, step: float) -> float:
        """Return the error of the tip to expect from a step [s], relative to the length.

        The step changes the root of each mode, and so its motion, by `phase_weighted` times the
        relative change; and it errs by some of the amplitude itself. Of a mode that the step does
        not resolve all is lost. The modes add up, as if they met at their worst.
        """
        at_once, in_root = STEP_ERRORS[integrator](step * self.rates, self)
        lost = np.minimum(
            self.amplitudes, self.amplitudes * at_once + self.phase_weighted * in_root
        )
        # what the modes of a free body lose in momentum, its base goes astray by; backward Euler
        # loses more in the modes than that
        astray = (
            FREE_BASE_FACTOR * (1 + self.travel)
            if self.is_free and integrator == "implicit"
            else 1.0
        )
        return float(lost.sum()) / self.length * astray

    def recommended_step_for(self, integrator: Integrator, target: float) -> float:
        """Return the largest step of 1, 2 or 5 times a power of ten [s] whose error is in reach.

        `target` is the error of the tip relative to the length.
        """
        for exponent in range(-2, -9, -1):
            for digit in reversed(STEP_DIGITS):
                step = float(f"{digit:g}e{exponent}")
                if step <= LARGEST_STEP and self.error(integrator, step) <= target:
                    return step
        return float(f"{STEP_DIGITS[0]:g}e-8")


def _second_order(h_rate: Array, motion: ModalMotion) -> tuple[Array, Array]:
    # of fourth order are the springs alone; gravity and loads are where a leapfrog step has them,
    # (h ω)²/24, and so are Coriolis forces, which grow with the square of the angles
    others = np.abs(1 - motion.spring_shares) / 24 + CORIOLIS_FACTOR * motion.bend**2
    return AMPLITUDE_ERROR["implicit"] * h_rate**2, h_rate**2 * others + h_rate**4 / 240


def _first_order(h_rate: Array, motion: ModalMotion) -> tuple[Array, Array]:
    # backward Euler damps by h K / 2, K being the springs: gravity takes no part
    return AMPLITUDE_ERROR["euler"] * h_rate, 0.5 * h_rate * np.abs(motion.spring_shares)


def _symplectic(h_rate: Array, motion: ModalMotion) -> tuple[Array, Array]:
    # symplectic Euler: of first order only in what it starts from, its phase is of second
    return 0.5 * h_rate, h_rate**2 / 24


STEP_ERRORS = {"implicit": _second_order, "euler": _first_order, "explicit": _symplectic}

AMPLITUDE_ERROR = {"implicit": 0.12, "euler": 0.8}
CORIOLIS_FACTOR = 0.03
FREE_BASE_FACTOR = 3.0
"""The four numbers that theory does not give, fitted to runs; all else is linear.

Judged where it matters, at true errors between 1e-4 and 5e-2 of the length, by predicted over true
error (tests/analysis/test_prediction.py). Over the scenes that the numbers were fitted to, of 67
runs none is more than 1 % too good, the median is 2.1, 70 % are within 3 and the worst is 18 times
too bad (backward Euler, a free snake). Over scenes drawn at random, which no number was fitted to,
the median of 48 runs is 1.7 and 83 % are within 3 either way, the worst 10 times too bad; 6 % are
too good by more than a third, by twice at most. In the worst of two other draws it was 11 % of
70, by three times at most: free bodies and stiff ones. Chains that topple are in none of these.
"""


def predict_motion(
    plan: Plan, body: Body, pose: ChainPose, modes: Modes, horizon: float = HORIZON
) -> ModalMotion:
    """Return how a body will move within so many seconds from its start at this pose.

    As far as its modes there tell: nothing of what a chain does that topples, and little of one
    that bends by more than a radian a joint. A body that nothing moves is taken to be let go in
    gravity of 9.81 m/s² sideways.
    """
    chain, length = pose.chain, body.chain.length
    # of an assembly the tip that a mode moves most
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
