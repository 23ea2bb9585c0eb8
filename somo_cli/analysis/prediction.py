"""What error of the tip to expect from a step, without running: by the modes at the start."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.modes import Modes
from somo_cli.simulation.dynamics import ChainPose
from somo_cli.simulation.loads import generalised
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.scene import Integrator
from somo_cli.simulation.signal import Signal
from somo_cli.simulation.springs import Array

HORIZON = 5.0  # s: for how long an error may grow in what is hardly damped
SAMPLES = 4000  # of a signal
LARGEST = 0.05  # s: no longer step is ever recommended
STEPS = (1.0, 2.0, 5.0)  # times a power of ten
SWING = 2.0  # lengths: no tip moves farther from where it started


@dataclass(frozen=True, slots=True)
class Motion:
    """How each mode moves the tip, one number a mode, shape (n,); slow modes first.

    `amplitudes` [engine length] are those of free vibration about what is static; `frequencies`
    [rad/s] and damping ratios say how long it lasts. `length` is the chain's; `travel` is how far
    a free base carries it in the meantime, turning included, in lengths. `turns` [rad], shape
    (n, n), holds by how much each joint, one a row, turns in each mode.
    """

    amplitudes: Array
    frequencies: Array
    ratios: Array
    length: float
    travel: float
    turns: Array

    @property
    def swings(self) -> Array:
        """A bound on how far each joint goes from its start [rad], shape (n,).

        Twice the amplitudes: a mode that is let go swings past its rest by as much again.
        """
        bound: Array = 2 * self.turns.sum(axis=1)
        return bound

    def turn_in(self, step: float) -> float:
        """Return the most that a joint may turn in one step [rad].

        By ω times its amplitude in each mode, or ω/2ζ of it where the damper holds it back; a mode
        that is not resolved turns by its amplitude at once.
        """
        held_back = np.maximum(1.0, 2 * self.ratios)
        in_step = np.minimum(1.0, step * self.frequencies / held_back)
        return float((self.turns @ in_step).max())

    def error(self, integrator: Integrator, step: float) -> float:
        """Return the error of the tip to expect from a step [s], relative to the length.

        To first order in the error of each mode, which grows with the angle ω t that the mode has
        turned by as its amplitude falls as exp(-ζ ω t): so it is largest at 1/(e ζ). Of a mode
        that the step does not resolve all is lost. The modes add up, as if they met at their
        worst.
        """
        h_omega = step * self.frequencies
        with np.errstate(divide="ignore"):
            turned = np.minimum(self.frequencies * HORIZON, 1 / (math.e * self.ratios))
        shares = np.minimum(1.0, GROWTH[integrator](h_omega, turned))
        # what the modes of a free body lose in momentum, its base goes astray by
        return float(self.amplitudes @ shares) / self.length * (1 + self.travel)

    def recommended(self, integrator: Integrator, target: float) -> float:
        """Return the largest step of 1, 2 or 5 times a power of ten [s] whose error is in reach.

        `target` is the error of the tip relative to the length.
        """
        for exponent in range(-2, -9, -1):
            for digit in reversed(STEPS):
                step = float(f"{digit:g}e{exponent}")
                if step <= LARGEST and self.error(integrator, step) <= target:
                    return step
        return float(f"{STEPS[0]:g}e-8")


def _second_order(h_omega: Array, turned: Array) -> Array:
    return SECOND * h_omega**2 * (1 + turned)


def _first_order(h_omega: Array, turned: Array) -> Array:
    return FIRST * h_omega * (1 + turned)


def _symplectic(h_omega: Array, turned: Array) -> Array:
    # symplectic Euler: of first order only in what it starts from, its phase is of second
    return 0.5 * h_omega + h_omega**2 / 24 * turned


SECOND = 0.05
"""Relative error of a mode over (h ω)², for each radian that it has turned by.

A linear mode errs by less, (h ω)⁴/240; but turning links couple modes by Coriolis forces, which
are followed to second order. Such that no run of a shipped scene is worse than predicted; most
are better, by up to twenty times (tests/analysis/test_prediction.py).
"""

FIRST = 0.8
"""The same over h ω for backward Euler: 1/2, and what turning links add."""

GROWTH = {"implicit": _second_order, "euler": _first_order, "explicit": _symplectic}


def motion_of(plan: Plan, body: Body, pose: ChainPose, modes: Modes) -> Motion:
    """Return how a body will move from its start at this pose, as far as its modes tell.

    It swings about its equilibrium, which what acts on it moves; the swing that a torque leaves
    behind depends on how slowly it changes. A body that nothing moves is taken to be let go in
    gravity of 9.81 m/s² sideways.
    """
    chain, length = pose.chain, body.chain.length
    is_free = body.base == "free"
    squares = np.abs(modes.squares)
    squares = np.maximum(squares, 1e-12 * float(squares.max()))
    frequencies = np.sqrt(np.maximum(squares, 1e-30))
    tips = np.linalg.norm(_tip_jacobian(pose) @ modes.shapes, axis=0)

    def moved_by(force: Array) -> Array:
        moved: Array = np.abs(modes.shapes.T @ felt_by_joints(pose, force, is_free))
        moved /= frequencies**2
        return moved

    springs = np.zeros(6 + chain.count)
    springs[6:] = -chain.stiffness * (pose.angles - chain.neutral)
    swings = moved_by(springs + pose.gravity_force(plan.gravity))
    swings += np.abs(np.linalg.solve(modes.shapes, np.array(body.start.rates))) / frequencies
    for force, signal in _driven(body, pose):
        swings += moved_by(force) * left_by(signal, frequencies)
    amplitudes = np.minimum(tips * swings, SWING * length)
    if amplitudes.sum() <= 1e-12 * length:
        x, y, z = 9.81 * plan.scale.length * _across(pose)
        sideways = (float(x), float(y), float(z))
        amplitudes = np.minimum(tips * moved_by(pose.gravity_force(sideways)), SWING * length)
    speed, spin = map(np.linalg.norm, (body.start.linear_velocity, body.start.angular_velocity))
    travel = float(speed / length + spin) * HORIZON if is_free else 0.0
    turns = np.abs(modes.shapes) * swings
    return Motion(amplitudes, frequencies, modes.ratios, length, travel, turns)


def felt_by_joints(pose: ChainPose, force: Array, is_free: bool) -> Array:
    """Return the joint torques, (n,), that move the joints as a generalised force, (6 + n,), does.

    A held base bears its own part; of a free one the joints feel that it gives way.
    """
    if not is_free:
        return force[6:]
    mass = pose.mass_matrix()
    felt: Array = force[6:] - mass[6:, :6] @ np.linalg.solve(mass[:6, :6], force[:6])
    return felt


def left_by(signal: Signal, frequencies: Array) -> Array:
    """Return the most that a signal leaves in undamped modes, (n,), in its own unit.

    That is the largest of the sums of du exp(-i ω t) up to any time: all of it for a jump, little
    for a ramp that takes many periods.
    """
    end = HORIZON if signal.period is not None else max(signal.times[-1], 0.0)
    times = np.linspace(0.0, end, SAMPLES if end > 0 else 1)
    values = np.array([signal.at(time) for time in times.tolist()])
    changes = np.diff(values, prepend=0.0)
    some = np.flatnonzero(changes)
    if len(some) == 0:
        return np.zeros_like(frequencies)
    turns = np.exp(-1j * np.outer(times[some], frequencies))
    largest: Array = np.abs(np.cumsum(changes[some, np.newaxis] * turns, axis=0)).max(axis=0)
    return largest


def _driven(body: Body, pose: ChainPose) -> Iterator[tuple[Array, Signal]]:
    """Yield every actuation and load of a body: the generalised force of factor one, the factor."""
    for drive in body.drives:
        force = np.zeros(6 + pose.chain.count)
        force[6 + np.array(drive.joints, dtype=np.int64)] = 1.0
        yield force, drive.signal
    for load in body.loads:
        yield generalised(load, pose), load.signal


def _tip_jacobian(pose: ChainPose) -> Array:
    jacobian: Array = np.cross(pose.axes, pose.tip - pose.origins[1:]).T
    return jacobian


def _across(pose: ChainPose) -> Array:
    """Return a unit vector across the base's backbone, in which the first joint bends if it can."""
    along = pose.rotations[0, :, 2]
    across = np.cross(pose.axes[0], along)
    if np.linalg.norm(across) < 1e-6:
        across = pose.rotations[0, :, 0]
    unit: Array = across / np.linalg.norm(across)
    return unit
