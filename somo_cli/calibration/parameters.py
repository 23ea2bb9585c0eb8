"""What a fit may change: stiffness, damping and actuation gain of each axis of one manipulator."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from somo_cli.arrays import Array
from somo_cli.manipulator.compile import Compiled
from somo_cli.scene.actuation import Actuation
from somo_cli.scene.model import Manipulator, Scene

ParameterKind = Literal["stiffness", "damping", "gain"]
PARAMETER_KINDS: tuple[ParameterKind, ...] = ("stiffness", "damping", "gain")
UNITS: Mapping[ParameterKind, str] = {"stiffness": "N·m/rad", "damping": "N·m·s/rad", "gain": "1"}


@dataclass(frozen=True, slots=True)
class Parameter:
    """One number of an axis and its first guess, which a factor multiplies.

    The guess is that of a joint definition of the axis, its first; a gain starts at 1. Unknown to
    the solver is the logarithm of the factor of a stiffness or a damping, which cannot change
    sign, and the factor less one of a gain, which can.
    """

    what: ParameterKind
    actuator: int
    axis: int
    guess: float

    @property
    def name(self) -> str:
        """What it is, for a person."""
        return f"{self.what} of actuator {self.actuator}, axis {self.axis}"

    def factor(self, unknown: float) -> float:
        """Return the factor on the guess."""
        return 1 + unknown if self.what == "gain" else math.exp(unknown)

    def spread(self, unknown: float) -> float:
        """Return how much the factor changes per change of the unknown."""
        return 1.0 if self.what == "gain" else math.exp(unknown)


def parameters(one: Manipulator, whats: Sequence[ParameterKind]) -> Iterator[Parameter]:
    """Yield what can be fitted: damping where there is some, a gain where something drives."""
    driven = {(entry.actuator, entry.axis) for entry in one.actuation}
    for number, actuator in enumerate(one.compiled.definition.actuators):
        for axis in dict.fromkeys(actuator.channels):
            place = actuator.channels.index(axis)
            joint = actuator.joints[place]
            if joint.joint_type == "fixed":
                continue
            guesses: Mapping[ParameterKind, float] = {
                "stiffness": joint.stiffness,
                "damping": joint.damping,
                "gain": float((number, axis) in driven),
            }
            for what in whats:
                if guesses[what] > 0:
                    yield Parameter(what, number, axis, guesses[what])


def with_factors(
    scene: Scene, known: Sequence[Parameter], unknowns: Sequence[float] | Array
) -> Scene:
    """Return the scene, of one manipulator, with every parameter times its factor."""
    factors = {
        (one.what, one.actuator, one.axis): one.factor(float(unknown))
        for one, unknown in zip(known, unknowns, strict=True)
    }
    (manipulator,) = scene.manipulators
    one = dataclasses.replace(
        manipulator,
        compiled=_compiled(manipulator.compiled, factors),
        actuation=tuple(_actuation(entry, factors) for entry in manipulator.actuation),
    )
    return dataclasses.replace(scene, manipulators=(one,))


def _compiled(
    compiled: Compiled, factors: Mapping[tuple[ParameterKind, int, int], float]
) -> Compiled:
    joints = tuple(
        dataclasses.replace(
            joint,
            stiffness=joint.stiffness
            * factors.get(("stiffness", joint.actuator, joint.channel), 1.0),
            damping=joint.damping * factors.get(("damping", joint.actuator, joint.channel), 1.0),
        )
        for joint in compiled.chain.joints
    )
    return dataclasses.replace(compiled, chain=dataclasses.replace(compiled.chain, joints=joints))


def _actuation(
    entry: Actuation, factors: Mapping[tuple[ParameterKind, int, int], float]
) -> Actuation:
    gain = factors.get(("gain", entry.actuator, entry.axis), 1.0)
    return dataclasses.replace(entry, profile=entry.profile.scaled(gain))
