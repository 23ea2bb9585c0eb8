"""The moment arms of the joints of one axis, and the exact rules that follow from them.

A small force F acts across a straight actuator, clamped at its base, at a distance a from the base.
Joint i at x_i has the moment arm l_i = a - x_i, turns by F l_i / k_i and moves the point by l_i
times that angle, so that

    K = F / deflection = 1 / sum(l_i² / k_i).

With an equal torque T in all joints and the point held, sum(θ_i l_i) = 0, θ_i = (T - F l_i) / k_i:

    F = T sum(l_i / k_i) / sum(l_i² / k_i).

Both hold for a torsion axis with l_i = 1, a moment instead of F and an angle instead of the
deflection. With many evenly placed joints on a length L they tend to F = 1.5 T / L and
K = 3 EI / L³.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import joint_placement
from somo_cli.manipulator.definition import ActuatorDefinition, Definition, Placement
from somo_cli.manipulator.geometry import Vector, norm, unit

Kind = Literal["bending", "torsion"]

_ALONG = 1e-6  # cosine or sine below which an axis is across or along the backbone


class NoMomentArms(ValueError):
    """There is nothing to calibrate: no such axis, or no joint that moves the point."""


@dataclass(frozen=True, slots=True)
class MomentArms:
    """The joints of one axis of an actuator of length `length` [m].

    `places`, shape (n,), and `at`, where the force acts, are distances from the base [m]. A joint
    stands for `shares` evenly placed joints, each with the stiffness of the first joint times
    `profile`; both have shape (n,).
    """

    kind: Kind
    direction: Vector  # of the axis
    places: Array
    shares: Array
    profile: Array
    at: float
    length: float

    @property
    def count(self) -> int:
        """Number of joints of the axis."""
        return len(self.places)

    @property
    def arms(self) -> Array:
        """Moment arms of the force [m], 0 for joints beyond it; 1 for torsion; shape (n,)."""
        arms: Array = np.maximum(self.at - self.places, 0.0)
        return np.sign(arms) if self.kind == "torsion" else arms

    @property
    def _compliances(self) -> Array:
        """Compliance of each joint times the stiffness of the first, if that is evenly placed."""
        return self.shares / self.profile

    def stiffness(self, tip_stiffness: float) -> float:
        """Return the `spring_stiffness` [N·m/rad] that gives the chain this tip stiffness.

        The tip stiffness is that of the point at `at`, in N/m, or in N·m/rad for torsion.
        """
        return float(tip_stiffness * (self._compliances @ self.arms**2))

    def tip_stiffness(self, stiffness: float) -> float:
        """Return the tip stiffness [N/m, N·m/rad] of a chain with this `spring_stiffness`."""
        return stiffness / float(self._compliances @ self.arms**2)

    def rigidity(self, tip_stiffness: float) -> float:
        """Return EI [N·m²] of the uniform beam with this tip stiffness; GJ for torsion.

        K = 3 EI / a³ and GJ / a: Timoshenko, Strength of Materials I (1955), sec. 32 and 58.
        """
        return tip_stiffness * (self.at if self.kind == "torsion" else self.at**3 / 3)

    def tip_stiffness_of_beam(self, rigidity: float) -> float:
        """Return the tip stiffness of a uniform beam with this EI, or GJ [N·m²]."""
        return rigidity / self.rigidity(1.0)

    def torque(self, force: float) -> float:
        """Return the torque in every joint [N·m] that causes this blocked force [N], or moment."""
        compliances = self._compliances
        return float(force * (compliances @ self.arms**2) / (compliances @ self.arms))

    def somo_stiffness(self, tip_stiffness: float) -> float:
        """Return the joint stiffness of SoMo's notes, k = L² K / (3/(2N) - 1/(2N²)) for N joints.

        It treats every joint like one at the clamp that stands for half a segment, so the chain is
        too stiff, by up to a factor of two.
        """
        n = self.count
        return tip_stiffness * self.at**2 / (3 / (2 * n) - 1 / (2 * n * n))

    def somo_torque(self, force: float) -> float:
        """Return the joint torque of SoMo's notes, T = F L [N·m]."""
        return force * self.at


def of_definition(
    definition: Definition, actuator: int, axis: int, at: float | None = None
) -> MomentArms:
    """Return the moment arms of an axis of an actuator that is clamped by itself.

    The force acts at a distance `at` [m] from the base of the actuator, None for its end. Raises
    NoMomentArms.
    """
    if not 0 <= actuator < len(definition.actuators):
        raise NoMomentArms(
            f"there is no actuator {actuator}, only {len(definition.actuators)} of them"
        )
    one = definition.actuators[actuator]
    numbers = [number for number, channel in enumerate(one.channels) if channel == axis]
    moving = [number for number in numbers if one.joints[number].joint_type != "fixed"]
    if not moving:
        what = "moves no joint" if numbers else "does not exist"
        raise NoMomentArms(f"axis {axis} of actuator {actuator} {what}")
    if one.taper != 1:
        raise NoMomentArms(f"actuator {actuator} has a taper: only uniform ones are calibrated")
    if any(joint.neutral_position for joint in one.joints):
        raise NoMomentArms(f"actuator {actuator} is not straight at rest: joint_neutral_position")
    kind, direction = _kind(one.joints[moving[0]].axis)
    skew = _skew_axis(one, axis, direction)
    if skew is not None:
        raise NoMomentArms(
            f"axes {axis} and {skew} of actuator {actuator} are not at right angles, so a "
            "force bends both"
        )
    length = one.n_segments * one.link.height
    ends = np.cumsum(one.fractions) * one.link.height
    offsets = [one.joints[number].offset[2] for number in moving]
    return _checked(
        MomentArms(
            kind,
            direction,
            places=ends[moving] + offsets,
            shares=np.array([one.shares[number] for number in moving]),
            profile=_profile(one, moving),
            at=length if at is None else at,
            length=length,
        )
    )


def _skew_axis(one: ActuatorDefinition, axis: int, direction: Vector) -> int | None:
    """Return another axis of an actuator that is not at right angles to this one, if there is."""
    for other, joint in zip(one.channels, one.joints, strict=True):
        along = abs(sum(a * b for a, b in zip(direction, unit(joint.axis), strict=True)))
        if other != axis and joint.joint_type != "fixed" and along > _ALONG:
            return other
    return None


def of_uniform_actuator(
    length: float,
    joints: int,
    axes: int,
    axis: int,
    direction: Vector,
    placing: Placement,
    at: float | None = None,
) -> MomentArms:
    """Return the moment arms of an actuator with `joints` joints on each of `axes` axes.

    Raises NoMomentArms.
    """
    turns = [number % axes for number in range(joints * axes)]
    where = joint_placement.layout(placing, turns, axes)
    own = [number for number, turn in enumerate(turns) if turn == axis]
    return _checked(
        MomentArms(
            *_kind(direction),
            places=length * np.array([where.places[number] for number in own]),
            shares=np.array([where.shares[number] for number in own]),
            profile=np.ones(len(own)),
            at=length if at is None else at,
            length=length,
        )
    )


def of_joint_positions(
    length: float, places: Sequence[float], direction: Vector, at: float | None = None
) -> MomentArms:
    """Return the moment arms of equal joints of one axis at these distances from the base [m].

    Raises NoMomentArms.
    """
    outside = [place for place in places if not 0 <= place < length]
    if outside:
        raise NoMomentArms(f"a joint at {outside[0]:g} m is not on the {length:g} m of actuator")
    return _checked(
        MomentArms(
            *_kind(direction),
            places=np.array(sorted(places)),
            shares=np.ones(len(places)),
            profile=np.ones(len(places)),
            at=length if at is None else at,
            length=length,
        )
    )


def _checked(moment_arms: MomentArms) -> MomentArms:
    if not 0 < moment_arms.at <= moment_arms.length * (1 + 1e-9):
        raise NoMomentArms(
            f"{moment_arms.at:g} m is not a place on the {moment_arms.length:g} m of actuator"
        )
    if not moment_arms.arms.any():
        raise NoMomentArms(
            f"no joint of the axis lies before {moment_arms.at:g} m, where the force acts"
        )
    return moment_arms


def _kind(axis: Vector) -> tuple[Kind, Vector]:
    direction = unit(axis)
    if abs(direction[2]) < _ALONG:
        return "bending", direction
    if norm((direction[0], direction[1], 0.0)) < _ALONG:
        return "torsion", direction
    raise NoMomentArms(f"an axis along {list(axis)} both bends and twists")


def _profile(one: ActuatorDefinition, numbers: Sequence[int]) -> Array:
    stiffness = np.array([one.joints[number].stiffness for number in numbers])
    if not stiffness.any():
        return np.ones(len(numbers))
    if not stiffness.all():
        raise NoMomentArms("some joints of the axis have a spring, and others have none")
    profile: Array = stiffness / stiffness[0]
    return profile
