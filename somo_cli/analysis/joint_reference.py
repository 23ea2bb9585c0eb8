"""The motion of a single joint in closed form: a pendulum or a damped oscillator."""

from __future__ import annotations

import math
from dataclasses import dataclass

from somo_cli.analysis.reference_scene import TOLERANCE, ReferenceMismatch, single_manipulator
from somo_cli.arrays import Array
from somo_cli.manipulator.chain import Joint
from somo_cli.scene.model import Manipulator, Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics

SINGLE_JOINT = ("pendulum", "damped_oscillator")


@dataclass(frozen=True, slots=True)
class _Hinge:
    """The joint, its start [rad, rad/s], the inertia that it turns [kg·m²], and gravity on it.

    The torque of gravity at the angle q is -`weight` sin(q - `lowest`) [N·m, rad].
    """

    joint: Joint
    angle: float
    rate: float
    inertia: float
    weight: float
    lowest: float


def joint_motion(scene: Scene, times: Array) -> Array:
    """Return the angle [rad] of the only joint at times [s], shape (n,).

    Raises ReferenceMismatch for a scene that the closed form does not describe.
    """
    one = single_manipulator(scene)
    hinge = _hinge(one, scene)
    if scene.reference == "damped_oscillator":
        return _oscillation(one, hinge, times)
    return _swing(one, hinge, times)


def _hinge(one: Manipulator, scene: Scene) -> _Hinge:
    chain = ChainDynamics(one.compiled.chain)
    if chain.count != 1:
        raise ReferenceMismatch(f"it is about a single joint, not {chain.count}")
    if one.loads:
        raise ReferenceMismatch("it is about a joint without external loads")
    joint = one.compiled.chain.joints[0]
    if joint.friction:
        raise ReferenceMismatch("it is about a joint without dry friction")
    base = one.pose
    angle = one.initial_angles[0]
    inertia = float(chain.at([angle], base).joint_inertia()[0, 0])

    def gravity_torque(at: float) -> float:
        return float(chain.at([at], base).gravity_force(scene.gravity)[6])

    # a weight's torque on a hinge is a sine of the angle, so two values determine it
    sine, cosine = gravity_torque(0.0), -gravity_torque(math.pi / 2)
    return _Hinge(
        joint, angle, one.initial_rates[0], inertia, math.hypot(sine, cosine),
        math.atan2(sine, cosine),
    )  # fmt: skip


def _oscillation(one: Manipulator, hinge: _Hinge, times: Array) -> Array:
    from somo_cli.analysis import closed_forms  # needs scipy, which is slow to import

    joint = hinge.joint
    if hinge.weight > TOLERANCE * max(1e-12, joint.stiffness):
        raise ReferenceMismatch("it is about a joint that gravity does not turn")
    constants = [entry.profile.constant_value for entry in one.actuation]
    if None in constants:
        raise ReferenceMismatch("it is about a constant torque")
    if joint.stiffness == 0:
        raise ReferenceMismatch("it is about a joint with a spring")
    torque = sum(constant or 0.0 for constant in constants)
    rest = joint.neutral_position + torque / joint.stiffness
    start = (hinge.angle - rest, hinge.rate)
    return rest + closed_forms.oscillator(
        times, hinge.inertia, joint.damping, joint.stiffness, start
    )


def _swing(one: Manipulator, hinge: _Hinge, times: Array) -> Array:
    from somo_cli.analysis import closed_forms  # needs scipy, which is slow to import

    if hinge.joint.stiffness or hinge.joint.damping or one.actuation:
        raise ReferenceMismatch("it is about a joint without spring, damper and actuation")
    if hinge.weight == 0:
        raise ReferenceMismatch("it is about a joint that gravity turns")
    swing = math.remainder(hinge.angle - hinge.lowest, 2 * math.pi)
    frequency = math.sqrt(hinge.weight / hinge.inertia)
    try:
        return hinge.angle - swing + closed_forms.pendulum(times, frequency, swing, hinge.rate)
    except ValueError as error:
        raise ReferenceMismatch(str(error)) from error
