"""Rotations over time: by roll, pitch and yaw, or by quaternions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix
from somo_cli.scene.signals import PiecewiseSignal

VectorSignal: TypeAlias = tuple[PiecewiseSignal, PiecewiseSignal, PiecewiseSignal]


class RotationSignal(Protocol):
    """A rotation at every time."""

    @property
    def components(self) -> Sequence[PiecewiseSignal]:
        """The numbers over time that give the rotation."""

    def rotation(self, values: Sequence[float]) -> Matrix | None:
        """Return the rotation that these components give; None if they turn nothing."""

    def small_angles(self) -> VectorSignal:
        """Return angles about the world's x, y and z [rad], up to a constant, near the start."""


@dataclass(frozen=True, slots=True)
class RollPitchYawSignal:
    """A rotation by roll, pitch and yaw [rad], interpolated as numbers."""

    components: VectorSignal

    def rotation(self, values: Sequence[float]) -> Matrix | None:
        """Return the rotation by roll, pitch and yaw [rad]; None if they turn nothing."""
        rpy = geometry.vector(values)
        return None if rpy == geometry.ZERO else geometry.rotation_from_rpy(rpy)

    def small_angles(self) -> VectorSignal:
        """Return roll, pitch and yaw: near zero they are angles about x, y and z [rad]."""
        return self.components


@dataclass(frozen=True, slots=True)
class QuaternionSignal:
    """A rotation by quaternions x, y, z, w, each interpolated as a number, then normalised.

    It has no singular direction, as roll, pitch and yaw have at a pitch of π/2. It takes the way
    of a slerp, at a rate that varies in between: by 4 % where two of them are π/4 apart.
    """

    components: tuple[PiecewiseSignal, PiecewiseSignal, PiecewiseSignal, PiecewiseSignal]

    def rotation(self, values: Sequence[float]) -> Matrix | None:
        """Return the rotation of a quaternion of any length; None if it turns nothing."""
        size = math.hypot(*values)
        x, y, z, w = (value / size for value in values)
        if x == y == z == 0:
            return None
        return geometry.rotation_from_quaternion((x, y, z, w))

    def small_angles(self) -> VectorSignal:
        """Return twice the vector part of the rotation since the start: angles [rad] near it."""
        x, y, z, w = (one.at(0.0) for one in self.components)
        # the vector part of q times the conjugate of the start, linear in q
        return (
            _combined(self.components, (2 * w, -2 * z, 2 * y, -2 * x)),
            _combined(self.components, (2 * z, 2 * w, -2 * x, -2 * y)),
            _combined(self.components, (-2 * y, 2 * x, 2 * w, -2 * z)),
        )


def _combined(signals: Sequence[PiecewiseSignal], weights: Sequence[float]) -> PiecewiseSignal:
    """Return a weighted sum of signals that have the same times."""
    pieces = []
    for of_signals in zip(*(one.pieces for one in signals), strict=True):
        c0, c1, c2, c3 = (
            math.fsum(weight * value for weight, value in zip(weights, values, strict=True))
            for values in zip(*of_signals, strict=True)
        )
        pieces.append((c0, c1, c2, c3))
    return PiecewiseSignal(signals[0].times, tuple(pieces), signals[0].period)
