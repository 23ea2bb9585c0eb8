"""Parameters of a fit: stiffness, damping and actuation gain of each axis of a manipulator."""

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
    """One parameter of an axis, as a factor on its first guess.

    The guess is the value of the first joint definition of the axis; a gain starts at 1. The
    solver's unknown is the logarithm of the factor of a stiffness or a damping, which cannot change
    sign, and the factor minus one of a gain, which can.
    """

    kind: ParameterKind
    actuator: int
    axis: int
    guess: float

    @property
    def name(self) -> str:
        """The parameter in words."""
        return f"{self.kind} of actuator {self.actuator}, axis {self.axis}"

    def factor(self, unknown: float) -> float:
        """Return the factor on the guess."""
        return 1 + unknown if self.kind == "gain" else math.exp(unknown)

    def spread(self, unknown: float) -> float:
        """Return the derivative of the factor by the unknown."""
        return 1.0 if self.kind == "gain" else math.exp(unknown)


def parameters(one: Manipulator, kinds: Sequence[ParameterKind]) -> Iterator[Parameter]:
    """Yield the parameters of these kinds that can be fitted, by actuator and axis.

    A stiffness or damping of zero cannot be fitted, nor the gain of an axis without actuation.
    """
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
            for kind in kinds:
                if guesses[kind] > 0:
                    yield Parameter(kind, number, axis, guesses[kind])


def with_factors(
    scene: Scene, known: Sequence[Parameter], unknowns: Sequence[float] | Array
) -> Scene:
    """Return the scene, of one manipulator, with every parameter multiplied by its factor."""
    factors = {
        (one.kind, one.actuator, one.axis): one.factor(float(unknown))
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
