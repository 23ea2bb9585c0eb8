"""Prescribed motion: how a base or an object is led through the world, over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Angle, Length, Position, Time
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import signals
from somo_cli.scene.signals import PiecewiseSignal

MotionInterpolation = Literal["linear", "cubic"]
VectorSignal = tuple[PiecewiseSignal, PiecewiseSignal, PiecewiseSignal]

NO_DISPLACEMENT = ((0.0, 0.0, 0.0, 0.0),)  # at all times


@dataclass(frozen=True, slots=True)
class PrescribedMotion:
    """Displacement and rotation over time: [time, three numbers], in the world's axes.

    The rotation is by roll, pitch and yaw about the point `about` of the world, or about the own
    origin; the displacement comes after it, so that it carries the point along.
    """

    translation: tuple[tuple[Time, Length, Length, Length], ...]
    rotation: tuple[tuple[Time, Angle, Angle, Angle], ...]
    about: Position | None
    interpolation: MotionInterpolation
    repeat: bool

    def path_from(self, start: Pose) -> PosePath:
        """Return the poses over time of a frame that starts there, all in one set of units."""
        interpolation, repeat = self.interpolation, self.repeat
        return PosePath(
            start,
            start.position if self.about is None else self.about,
            vector_signal(self.translation, interpolation, repeat),
            vector_signal(self.rotation, interpolation, repeat),
        )


@dataclass(frozen=True, slots=True)
class PosePath:
    """The pose of a frame at every time: `start` turned about a point, then displaced."""

    start: Pose
    about: Vector
    translation: VectorSignal
    rotation: VectorSignal

    def at(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        x, y, z = self.translation
        roll, pitch, yaw = self.rotation
        return self._pose(
            (x.at(time), y.at(time), z.at(time)), (roll.at(time), pitch.at(time), yaw.at(time))
        )

    def pose_before_start(self, time: float) -> Pose:
        """Return where the frame would have been so long before the start [s], moving as then."""
        displacements = [[_extrapolated(one, -time) for one in three] for three in self._components]
        return self._pose(geometry.vector(displacements[0]), geometry.vector(displacements[1]))

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the pose stays what it is at `time`."""
        return min(one.constant_until(time) for three in self._components for one in three)

    def stationary_until(self, time: float, step: float) -> float:
        """Return the time [s] up to which the pose a step later is that at `time`."""
        return max(time, self.constant_until(time) - step)

    @property
    def _components(self) -> tuple[VectorSignal, VectorSignal]:
        return self.translation, self.rotation

    def _pose(self, displacement: Vector, rpy: Vector) -> Pose:
        if rpy == geometry.ZERO:
            return Pose(geometry.add(self.start.position, displacement), self.start.rotation)
        turn = geometry.rotation_from_rpy(rpy)
        lever_arm = geometry.rotate(turn, geometry.subtract(self.start.position, self.about))
        position = geometry.add(geometry.add(self.about, lever_arm), displacement)
        return Pose(position, geometry.multiply(turn, self.start.rotation))


def read_motion(data: Mapping[str, Any]) -> PrescribedMotion:
    """Return the motion that a sound mapping describes."""
    return PrescribedMotion(
        translation=_float_rows(data.get("translation", NO_DISPLACEMENT)),
        rotation=_float_rows(data.get("rotation", NO_DISPLACEMENT)),
        about=geometry.vector(data["about"]) if "about" in data else None,
        interpolation=data.get("interpolation", "cubic"),
        repeat=bool(data.get("repeat", False)),
    )


def vector_signal(
    points: Sequence[tuple[float, float, float, float]],
    interpolation: MotionInterpolation,
    repeat: bool,
) -> VectorSignal:
    """Return a signal for each of three numbers through [time, three numbers]."""
    repeats = repeat and len(points) > 1  # rest has no period
    x, y, z = (
        signals.piecewise_signal(
            [(point[0], point[axis]) for point in points], interpolation, repeats
        )
        for axis in (1, 2, 3)
    )
    return x, y, z


def _extrapolated(one: PiecewiseSignal, time: float) -> float:
    """Return the value at a time [s] of the piece in which time zero lies, without its ends."""
    index = max((i for i, begin in enumerate(one.times) if begin <= 0), default=-1)
    if index < 0:
        return one.pieces[0][0]
    c0, c1, c2, c3 = one.pieces[index]
    s = time - one.times[index]
    return c0 + s * (c1 + s * (c2 + s * c3))


def _float_rows(points: Any) -> tuple[tuple[float, float, float, float], ...]:
    return tuple((float(t), float(x), float(y), float(z)) for t, x, y, z in points)
