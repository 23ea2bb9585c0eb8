"""What sets the modes of a chain in motion, and how much of it each keeps and for how long."""

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
from somo_cli.simulation.plan.model import Body

SAMPLES_PER_HORIZON = 4000  # of a horizon
MAX_SAMPLED_HORIZONS = 5  # horizons that are sampled as finely


@dataclass(frozen=True, slots=True)
class Vibration:
    """How modes vibrate about what is static, shape (n,), in modal coordinates.

    `largest` is the largest amplitude met. `phase_weighted` is the largest sum of what every push
    left, each times the angle |s| t that it has turned by since: to first order, the change of the
    motion
    is that times the relative change of the mode's root s.
    """

    largest: Array
    phase_weighted: Array


def vibration(
    body: Body, pose: ChainPose, modes: Modes, gravity: Vector, horizon: float
) -> Vibration:
    """Return how a body vibrates within so many seconds [s] of a start at this pose.

    Or of the last way-point, if that comes later.

    Springs, gravity, what drives the body and loads push together, each at its time: waves that
    are out of step cancel, and a slow ramp leaves little. Forces are those at the start pose.
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
    pushes = np.zeros((len(start), len(times)), dtype=np.complex128)
    # a rate v goes on as (v / ω) sin ω t, a push of f as -(f / ω²) cos ω t
    pushes[:, 0] = start + 1j * modes.moduli * rates
    for force, signal in driven:
        values = np.array([signal.at(time) for time in times.tolist()])
        changes = np.diff(values, prepend=0.0)
        pushes += np.outer(_modal(body, pose, modes, force), changes)
    return modal_response(modes.roots, pushes, float(times[1]), modes.moduli)


def sideways_release(
    body: Body, pose: ChainPose, modes: Modes, gravity: float, horizon: float
) -> Vibration:
    """Return how a body vibrates that is let go in this gravity [engine units], across its base."""
    x, y, z = gravity * _across(pose)
    pushes = np.zeros((pose.chain.count, SAMPLES_PER_HORIZON), dtype=np.complex128)
    force = pose.gravity_force((float(x), float(y), float(z)))
    pushes[:, 0] = _modal(body, pose, modes, force)
    return modal_response(modes.roots, pushes, horizon / (SAMPLES_PER_HORIZON - 1), modes.moduli)


def modal_response(roots: Complex, pushes: Complex, interval: float, moduli: Array) -> Vibration:
    """Return what modes, their roots s [1/s], keep of pushes, (n, times), `interval` [s] apart.

    A push f is exp(s t) f / ω² at t later; with t as a further factor that is a filter with the
    same pole twice.
    """
    from scipy.signal import lfilter

    poles = np.exp(roots * interval)
    largest, phase_weighted = np.zeros((2, len(roots)))
    for mode, (pole, push) in enumerate(zip(poles, pushes, strict=True)):
        largest[mode] = np.abs(lfilter([1.0], [1.0, -pole], push)).max()
        turned = lfilter([0.0, pole * interval], [1.0, -2 * pole, pole**2], push)
        phase_weighted[mode] = abs(roots[mode]) * np.abs(turned).max()
    return Vibration(largest / moduli**2, phase_weighted / moduli**2)


def felt_by_joints(pose: ChainPose, force: Array, is_free: bool) -> Array:
    """Return the joint torques, (n,), that move the joints as a generalised force, (6 + n,), does.

    A held base bears its own part; of a free one the joints feel that it gives way.
    """
    if not is_free:
        return force[6:]
    mass = pose.mass_matrix()
    felt: Array = force[6:] - mass[6:, :6] @ np.linalg.solve(mass[:6, :6], force[:6])
    return felt


def _modal(body: Body, pose: ChainPose, modes: Modes, force: Array) -> Array:
    felt: Array = modes.shapes.T @ felt_by_joints(pose, force, body.base == "free")
    return felt


def _force_inputs(body: Body, pose: ChainPose) -> Iterator[tuple[Array, Signal]]:
    """Yield every actuation and load of a body: the generalised force of factor one, the factor."""
    for drive in body.drives:
        force = np.zeros(6 + pose.chain.count)
        force[6 + np.array(drive.joints, dtype=np.int64)] = 1.0
        yield force, drive.signal
    for load in body.loads:
        yield generalised_load_force(load, pose), load.signal
    if body.path is not None:
        yield from _base_motion_inputs(body.path, pose)


def _base_motion_inputs(path: PosePath, pose: ChainPose) -> Iterator[tuple[Array, Signal]]:
    """Yield what the joints feel of each part of the motion of their base, where it starts."""
    mass = pose.mass_matrix()
    arm = pose.centres[0] - np.array(path.about)
    for axis in range(3):
        unit = np.eye(3)[axis]
        straight = np.concatenate([np.zeros(3), unit])
        turning = np.concatenate([unit, np.cross(unit, arm)])
        for acceleration, signal in (
            (straight, path.translation[axis]),
            (turning, path.rotation[axis]),
        ):
            yield -mass[:, :6] @ acceleration, Acceleration(signal)


@dataclass(frozen=True, slots=True)
class Acceleration:
    """The second derivative of an input over time, taken over a few milliseconds.

    So a jump of the velocity, as between way-points with straight lines between them, is seen. The
    start is none: a motion starts with the velocity that it has.
    """

    displacement: Signal
    width: float = 5e-3  # s

    def at(self, time: float) -> float:
        """Return the value at a time [s]."""
        width, time = self.width, max(time, self.width)
        before, now, after = (self.displacement.at(time + shift) for shift in (-width, 0.0, width))
        return (before - 2 * now + after) / width**2

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the value stays what it is at `time`."""
        return max(time, self.displacement.constant_until(time) - self.width)

    @property
    def constant_from(self) -> float:
        """The time [s] from which on the value is held; 0 if it goes on for ever."""
        return self.displacement.constant_from + self.width


def _across(pose: ChainPose) -> Array:
    """Return a unit vector across the base's backbone, in which the first joint bends if it can."""
    along = pose.rotations[0, :, 2]
    across = np.cross(pose.axes[0], along)
    if np.linalg.norm(across) < 1e-6:
        across = pose.rotations[0, :, 0]
    unit: Array = across / np.linalg.norm(across)
    return unit
