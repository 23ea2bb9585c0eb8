"""The torque behind a blocked force, for joint angles of any size.

The actuator presses on a rigid, frictionless surface, which exerts a force F across the straight
actuator, of constant direction. The rule of `moment_arms` is exact for small angles only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import root

from somo_cli.arrays import Array
from somo_cli.calibration.moment_arms import MomentArms
from somo_cli.manipulator.chain_build import build_chain
from somo_cli.manipulator.definition import Definition
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose

MAX_JOINT_ANGLE = 1.5  # rad: with larger ones the actuator is not near the straight pose


@dataclass(frozen=True, slots=True)
class BlockedEquilibrium:
    """The torque in every joint of the axis [N·m], and all joint angles [rad], shape (n,)."""

    torque: float
    angles: Array


def blocked_equilibrium(
    definition: Definition, actuator: int, axis: int, moment_arms: MomentArms, force: float
) -> BlockedEquilibrium | None:
    """Return the equilibrium of an actuator that presses with a force [N] at `moment_arms.at`.

    The actuator is clamped by itself, weightless and straight at rest; the surface touches the
    straight actuator. Returns None where there is no such equilibrium near the straight pose, if a
    joint has no spring, and for torsion, where the rule of small angles is exact.
    """
    if moment_arms.kind == "torsion":
        return None
    one = definition.actuators[actuator]
    if force == 0:
        return BlockedEquilibrium(0.0, np.zeros(one.n_segments))
    alone = build_chain(replace(definition, base=None, actuators=(one,), tips=()))
    body = ChainDynamics(alone)
    if not (body.stiffness > 0).all():
        return None
    drives = np.array([joint.channel == axis for joint in alone.joints], dtype=float)
    places = np.cumsum([joint.origin[2] for joint in alone.joints])
    link = int(np.sum(places < moment_arms.at))
    across = np.cross(moment_arms.direction, (0.0, 0.0, 1.0))
    held = np.array((0.0, 0.0, moment_arms.at))
    start = body.at(np.zeros(body.count))
    local = held - start.origins[link]

    def residual(unknown: Array) -> Array:
        # torques relative to the small-angle value, distances relative to the length
        angles, torque = unknown[:-1], unknown[-1] * scale
        pose: ChainPose = body.at(angles)
        point = pose.point(link, local)
        pressed = pose.generalised_force(link, point, -force * across, np.zeros(3))[6:]
        rest = torque * drives - body.stiffness * angles + pressed
        apart = (point - held) @ across
        return np.append(rest / scale, apart / moment_arms.at)

    scale = moment_arms.torque(force)
    arms = np.where(drives > 0, np.maximum(moment_arms.at - places, 0), 0)
    small = (scale * drives - force * arms) / body.stiffness
    found = root(residual, np.append(small, 1.0), method="hybr", options={"xtol": 1e-12})
    is_near = bool(np.abs(found.x[:-1]).max() < MAX_JOINT_ANGLE)
    if not (found.success and is_near) or np.abs(found.fun).max() > 1e-9:
        return None
    return BlockedEquilibrium(float(found.x[-1] * scale), found.x[:-1])
