"""From a damping ratio to the damping of joints: the lowest mode of one axis.

With d = c k in the joints of an axis, a mode φ of M q'' + K q = 0 with frequency ω and φ' M φ = 1
has the damping ratio φ' D φ / (2 ω) = c sum(k φ²) / (2 ω), summed over the joints of the axis. If
no other joint bends in the mode, c = 2 ζ / ω (Rayleigh damping without its mass part: Clough and
Penzien, Dynamics of Structures (1993), sec. 12-5). With several actuators in series, modes belong
to no single actuator; the mode is then that of the axis with all other joints locked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from somo_cli.analysis.modes import SingularInertia, modes_at
from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.plan.model import Plan


class NoMode(ValueError):
    """The axis has no mode that vibrates."""


@dataclass(frozen=True, slots=True)
class Mode:
    """The lowest mode of an axis at the start of a scene, gravity included.

    `frequency` [rad/s] and damping `ratio` are those of the model; `share` is the share of the
    axis in the elastic energy; `is_alone` says that all other joints were locked.
    `seconds` is damping over stiffness, the mean over the joints of the axis [s], and `per_ratio`
    its value for a damping ratio of 1 [s].
    """

    frequency: float
    ratio: float
    share: float
    is_alone: bool
    seconds: float
    per_ratio: float


def lowest_mode(plan: Plan, body: int, actuator: int, axis: int) -> Mode:
    """Return the lowest mode of a body that has most of its elastic energy in one axis.

    With several actuators, all joints but those of the axis are locked. Raises NoMode.
    """
    one = plan.bodies[body]
    dynamics = ChainDynamics(one.chain)
    pose = dynamics.at(one.start.angles, one.start.pose)
    is_free = one.base == "free"
    inertia, gravity = pose.joint_inertia(is_free), pose.gravity_stiffness(plan.gravity)
    try:
        modes = modes_at(pose, is_free, gravity)
    except SingularInertia as error:
        raise NoMode(str(error)) from error
    drives = np.array([(j.actuator, j.channel) == (actuator, axis) for j in one.chain.joints])
    if not (dynamics.stiffness[drives] > 0).all():
        raise NoMode(f"joints of axis {axis} of actuator {actuator} have no spring_stiffness")
    seconds = float((dynamics.damping[drives] / dynamics.stiffness[drives]).mean())
    if len({joint.actuator for joint in one.chain.joints}) > 1:
        return _alone(dynamics, drives, inertia, gravity, seconds)
    energies = dynamics.stiffness[:, np.newaxis] * modes.shapes**2  # (joint, mode)
    shares: Array = energies[drives].sum(axis=0) / energies.sum(axis=0)
    for number, share in enumerate(shares):
        square = modes.squared_frequencies[number]
        if share > 0.5 and square > 0:
            frequency = math.sqrt(square)
            own = float(energies[drives, number].sum())
            ratio = float(modes.damping_ratios[number])
            return Mode(frequency, ratio, float(share), False, seconds, 2 * frequency / own)
    raise NoMode(f"axis {axis} of actuator {actuator} does not vibrate: gravity topples it")


def _alone(
    dynamics: ChainDynamics, drives: Array, inertia: Array, gravity: Array, seconds: float
) -> Mode:
    """Return the lowest mode of the joints in `drives`, bools of shape (n,), all others locked."""
    own = np.ix_(drives, drives)
    springs, dampers = (np.diag(all_[drives]) for all_ in (dynamics.stiffness, dynamics.damping))
    squares, vectors = eigh(springs + gravity[own], inertia[own])
    if squares[0] <= 0:
        raise NoMode("the axis does not vibrate: gravity topples it")
    frequency, shape = math.sqrt(squares[0]), vectors[:, 0]
    ratio = float(shape @ dampers @ shape) / (2 * frequency)
    return Mode(
        frequency, ratio, 1.0, True, seconds, 2 * frequency / float(shape @ springs @ shape)
    )
