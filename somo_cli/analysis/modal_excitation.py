"""How actuation, loads, gravity and base motion excite the modes of a chain."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from somo_cli.analysis.modes import Complex, Modes
from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.scene.prescribed_motion import PosePath
from somo_cli.scene.signals import Signal
from somo_cli.simulation.dynamics.chain_dynamics import ChainPose
from somo_cli.simulation.dynamics.external_loads import generalised_load_force
from somo_cli.simulation.dynamics.free_base import FreeBase
from somo_cli.simulation.plan.model import Body

SAMPLES_PER_HORIZON = 4000
MAX_SAMPLED_HORIZONS = 5  # longer times are sampled more coarsely


@dataclass(frozen=True, slots=True)
class Vibration:
    """Vibration of the modes about static equilibrium, in modal coordinates, shape (n,).

    `largest` is the largest amplitude. `phase_weighted` is the largest sum of the free vibrations
    after all changes of force, each times the phase angle |s| t since then. A relative
    change of the root s of a mode changes its motion by that much times `phase_weighted`, to first
    order.
    """

    largest: Array
    phase_weighted: Array


def vibration(
    body: Body, pose: ChainPose, modes: Modes, gravity: Vector, horizon: float
) -> Vibration:
    """Return the vibration of a body that starts at this pose, over a time `horizon` [s].

    If the inputs change after that time, it ends `horizon` after their last change. Springs,
    gravity, actuation and loads act together, each at its time, so that excitations out of phase
    cancel and a slow ramp excites little. Generalised forces are those at the start pose.
    """
    springs = np.zeros(6 + pose.chain.count)
    springs[6:] = -pose.chain.stiffness * (pose.angles - pose.chain.neutral)
    start = _modal(body, pose, modes, springs + pose.gravity_force(gravity))
    rates = np.linalg.solve(modes.shapes, np.array(body.start.rates))
    driven = list(_force_inputs(body, pose))
    last = max((one.constant_from for _, one in driven), default=0.0)
    end = horizon if last < horizon else last + horizon
    times = np.linspace(
        0.0, end, SAMPLES_PER_HORIZON * min(math.ceil(end / horizon), MAX_SAMPLED_HORIZONS)
    )
    excitation = np.zeros((len(start), len(times)), dtype=np.complex128)
    # a rate v continues as (v / ω) sin ω t, a step of the force f as -(f / ω²) cos ω t
    excitation[:, 0] = start + 1j * modes.moduli * rates
    for force, signal in driven:
        values = np.array([signal.at(time) for time in times.tolist()])
        changes = np.diff(values, prepend=0.0)
        excitation += np.outer(_modal(body, pose, modes, force), changes)
    return modal_response(modes.roots, excitation, float(times[1]), modes.moduli)


def sideways_release(
    body: Body, pose: ChainPose, modes: Modes, gravity: float, horizon: float
) -> Vibration:
    """Return the vibration of a body released in `gravity` [engine units] across its base."""
    x, y, z = gravity * _across(pose)
    excitation = np.zeros((pose.chain.count, SAMPLES_PER_HORIZON), dtype=np.complex128)
    force = pose.gravity_force((float(x), float(y), float(z)))
    excitation[:, 0] = _modal(body, pose, modes, force)
    return modal_response(
        modes.roots, excitation, horizon / (SAMPLES_PER_HORIZON - 1), modes.moduli
    )


def modal_response(
    roots: Complex, excitation: Complex, interval: float, moduli: Array
) -> Vibration:
    """Return the vibration of modes with roots s [1/s] after changes of their modal forces.

    `excitation`, shape (n, times), are the changes at times `interval` [s] apart. A change f causes
    exp(s t) f / ω² at a time t later, a recursive filter with one pole; times t it is a filter with
    a double pole.
    """
    from scipy.signal import lfilter

    poles = np.exp(roots * interval)
    largest, phase_weighted = np.zeros((2, len(roots)))
    for mode, (pole, changes) in enumerate(zip(poles, excitation, strict=True)):
        largest[mode] = np.abs(lfilter([1.0], [1.0, -pole], changes)).max()
        turned = lfilter([0.0, pole * interval], [1.0, -2 * pole, pole**2], changes)
        phase_weighted[mode] = abs(roots[mode]) * np.abs(turned).max()
    return Vibration(largest / moduli**2, phase_weighted / moduli**2)


def joint_force(pose: ChainPose, force: Array, is_free: bool) -> Array:
    """Return the joint torques, shape (n,), equivalent to a generalised force, shape (6 + n,).

    A static base bears the force on it; a free base accelerates, which acts on the joints.
    """
    return FreeBase.of(pose.mass_matrix()).joint_torques(force) if is_free else force[6:]


def _modal(body: Body, pose: ChainPose, modes: Modes, force: Array) -> Array:
    modal: Array = modes.shapes.T @ joint_force(pose, force, body.base == "free")
    return modal


def _force_inputs(body: Body, pose: ChainPose) -> Iterator[tuple[Array, Signal]]:
    """Yield each input of a body: its generalised force, shape (6 + n,), and the factor on it."""
    for drive in body.drives:
        force = np.zeros(6 + pose.chain.count)
        force[6 + np.array(drive.joints, dtype=np.int64)] = 1.0
        yield force, drive.signal
    for load in body.loads:
        yield generalised_load_force(load, pose), load.signal
    if body.path is not None:
        yield from _base_motion_inputs(body.path, pose)


def _base_motion_inputs(path: PosePath, pose: ChainPose) -> Iterator[tuple[Array, Signal]]:
    """Yield the inertial force of each component of a base motion, at the start, and its factor."""
    mass = pose.mass_matrix()
    arm = pose.centres[0] - np.array(path.about)
    angles = path.rotation.small_angles()
    for axis in range(3):
        unit = np.eye(3)[axis]
        straight = np.concatenate([np.zeros(3), unit])
        turning = np.concatenate([unit, np.cross(unit, arm)])
        for acceleration, signal in (
            (straight, path.translation[axis]),
            (turning, angles[axis]),
        ):
            yield -mass[:, :6] @ acceleration, Acceleration(signal)


@dataclass(frozen=True, slots=True)
class Acceleration:
    """The second derivative of an input over time, as a difference over a few milliseconds.

    The difference includes jumps of the velocity, as at waypoints that straight lines join. The
    start is not a jump: the base already has the initial velocity of its motion.
    """

    displacement: Signal
    width: float = 5e-3  # s

    def at(self, time: float) -> float:
        """Return the value at a time [s]."""
        width, time = self.width, max(time, self.width)
        before, now, after = (self.displacement.at(time + shift) for shift in (-width, 0.0, width))
        return (before - 2 * now + after) / width**2

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the value is constant from `time`."""
        return max(time, self.displacement.constant_until(time) - self.width)

    @property
    def constant_from(self) -> float:
        """The time [s] from which the value is constant; 0 if it never is."""
        return self.displacement.constant_from + self.width


def _across(pose: ChainPose) -> Array:
    """Return a unit vector across the backbone at the base, in which the first joint can bend."""
    along = pose.rotations[0, :, 2]
    across = np.cross(pose.axes[0], along)
    if np.linalg.norm(across) < 1e-6:
        across = pose.rotations[0, :, 0]
    unit: Array = across / np.linalg.norm(across)
    return unit
