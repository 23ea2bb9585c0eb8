"""Prescribed motion: the pose of a base or an object in the world over time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from somo_cli.document.table import read_table
from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Angle, Length, Number, Position, Time
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import pose_table, signals
from somo_cli.scene.rotation_signals import (
    QuaternionSignal,
    RollPitchYawSignal,
    RotationSignal,
    VectorSignal,
)
from somo_cli.scene.signals import PiecewiseSignal
from somo_cli.scene.sorotraj import Trajectory

MotionInterpolation = Literal["linear", "cubic"]
MotionFrame = Literal["start", "world"]

NO_DISPLACEMENT = ((0.0, 0.0, 0.0, 0.0),)  # at all times
POSITION_CHANNELS, POSE_CHANNELS = 3, 6
"""Channels of a trajectory used as motion: x, y, z [m], then roll, pitch, yaw [rad]."""


@dataclass(frozen=True, slots=True)
class PrescribedMotion:
    """Translation and rotation over time, along the axes of the world frame.

    The rotation is given by roll, pitch and yaw, or by unit `quaternions` (x, y, z, w) if there are
    any. It is about the world point `about`, or about the frame's origin if that is None. The
    translation follows it. With the frame "start" both are relative to the start pose; with the
    frame "world" they are the pose itself.
    """

    translation: tuple[tuple[Time, Length, Length, Length], ...]
    rotation: tuple[tuple[Time, Angle, Angle, Angle], ...]
    about: Position | None
    interpolation: MotionInterpolation
    repeat: bool
    quaternions: tuple[tuple[Time, Number, Number, Number, Number], ...] = ()
    frame: MotionFrame = "start"

    def path_from(self, start: Pose) -> PosePath:
        """Return the path of a frame that starts at `start`, which has the units of this motion.

        With the frame "world" the motion gives the start, and `start` is ignored.
        """
        translation = vector_signal(self.translation, self.interpolation, self.repeat)
        rotation = self._rotation_signal()
        if self.frame == "start":
            about = start.position if self.about is None else self.about
            return PosePath(start, about, translation, rotation)
        x, y, z = (one.at(0.0) for one in translation)
        displacement = (
            _shifted(translation[0], -x),
            _shifted(translation[1], -y),
            _shifted(translation[2], -z),
        )
        return PosePath(Pose((x, y, z)), (x, y, z), displacement, rotation)

    def start_in_world(self) -> tuple[Vector, Vector]:
        """Return position [m] and roll, pitch, yaw [rad] at time zero, for the frame "world"."""
        translation = vector_signal(self.translation, self.interpolation, self.repeat)
        rotation = self._rotation_signal()
        values = [one.at(0.0) for one in rotation.components]
        rpy = geometry.vector(values) if not self.quaternions else geometry.ZERO
        turn = rotation.rotation(values) if self.quaternions else None
        if turn is not None:
            rpy = geometry.rpy_from_rotation(turn)
        return geometry.vector([one.at(0.0) for one in translation]), rpy

    def _rotation_signal(self) -> RotationSignal:
        if not self.quaternions:
            return RollPitchYawSignal(vector_signal(self.rotation, self.interpolation, self.repeat))
        x, y, z, w = component_signals(self.quaternions, self.interpolation, self.repeat)
        return QuaternionSignal((x, y, z, w))


@dataclass(frozen=True, slots=True)
class PosePath:
    """The pose of a frame over time: `start`, rotated about the point `about`, then translated."""

    start: Pose
    about: Vector
    translation: VectorSignal
    rotation: RotationSignal

    def at(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        x, y, z = self.translation
        turn = self.rotation.rotation([one.at(time) for one in self.rotation.components])
        return self._pose((x.at(time), y.at(time), z.at(time)), turn)

    def pose_before_start(self, time: float) -> Pose:
        """Return the pose a time [s] before the start, extrapolated from the motion there."""
        turn = self.rotation.rotation(
            [_extrapolated(one, -time) for one in self.rotation.components]
        )
        displacement = [_extrapolated(one, -time) for one in self.translation]
        return self._pose(geometry.vector(displacement), turn)

    def constant_until(self, time: float) -> float:
        """Return the time [s] until which the pose stays as it is at `time`."""
        return min(
            one.constant_until(time) for one in (*self.translation, *self.rotation.components)
        )

    def stationary_until(self, time: float, step: float) -> float:
        """Return the time [s] until which no step [s] changes the pose; `time` if the next does."""
        return max(time, self.constant_until(time) - step)

    def _pose(self, displacement: Vector, turn: Matrix | None) -> Pose:
        if turn is None:
            return Pose(geometry.add(self.start.position, displacement), self.start.rotation)
        lever_arm = geometry.rotate(turn, geometry.subtract(self.start.position, self.about))
        position = geometry.add(geometry.add(self.about, lever_arm), displacement)
        return Pose(position, geometry.multiply(turn, self.start.rotation))


def read_motion(
    data: Mapping[str, Any], trajectories: Mapping[str, Trajectory] | None = None
) -> PrescribedMotion:
    """Return the motion of a checked mapping, from its waypoints, file or trajectory."""
    about = geometry.vector(data["about"]) if "about" in data else None
    repeat = bool(data.get("repeat", False))
    frame: MotionFrame = data.get("frame", "start")
    if "trajectory" in data:
        rows = _trajectory_rows((trajectories or {})[data["trajectory"]])
        return PrescribedMotion(
            *rows, about, data.get("interpolation", "linear"), repeat, (), frame
        )
    interpolation: MotionInterpolation = data.get("interpolation", "cubic")
    if "file" in data:
        table = read_table(data["file"]["text"], data["file"]["source"])
        poses = pose_table.read_pose_rows(table)
        return PrescribedMotion(
            poses.translation or NO_DISPLACEMENT,
            poses.rotation or NO_DISPLACEMENT,
            about,
            interpolation,
            repeat,
            poses.quaternions,
            frame,
        )
    return PrescribedMotion(
        translation=_float_rows(data.get("translation", NO_DISPLACEMENT)),
        rotation=_float_rows(data.get("rotation", NO_DISPLACEMENT)),
        about=about,
        interpolation=interpolation,
        repeat=repeat,
    )


def start_pose_of(
    data: Mapping[str, Any], motion: PrescribedMotion | None
) -> tuple[Vector, Vector]:
    """Return position [m] and roll, pitch, yaw [rad] at the start of a manipulator or object.

    `data` is the mapping that describes it. A motion with the frame "world" gives the start itself.
    """
    if motion is not None and motion.frame == "world":
        return motion.start_in_world()
    return (
        geometry.vector(data.get("position", (0, 0, 0))),
        geometry.vector(data.get("rpy", (0, 0, 0))),
    )


def vector_signal(
    points: Sequence[tuple[float, float, float, float]],
    interpolation: MotionInterpolation,
    repeat: bool,
) -> VectorSignal:
    """Return one signal for each of three components through points (time, x, y, z)."""
    x, y, z = component_signals(points, interpolation, repeat)
    return x, y, z


def component_signals(
    points: Sequence[Sequence[float]], interpolation: MotionInterpolation, repeat: bool
) -> list[PiecewiseSignal]:
    """Return one signal for each component through points (time, components)."""
    repeats = repeat and len(points) > 1  # a single point has no period
    times, *components = zip(*points, strict=True)
    return [
        signals.piecewise_signal(list(zip(times, values, strict=True)), interpolation, repeats)
        for values in components
    ]


def _shifted(one: PiecewiseSignal, by: float) -> PiecewiseSignal:
    """Return the signal with a number added to its value."""
    return replace(one, pieces=tuple((c0 + by, c1, c2, c3) for c0, c1, c2, c3 in one.pieces))


def _extrapolated(one: PiecewiseSignal, time: float) -> float:
    """Return the value at a time [s] of the piece at time zero, extended beyond its ends."""
    index = bisect_right(one.times, 0.0) - 1
    if index < 0:
        return one.pieces[0][0]
    c0, c1, c2, c3 = one.pieces[index]
    s = time - one.times[index]
    return c0 + s * (c1 + s * (c2 + s * c3))


def _float_rows(points: Any) -> tuple[tuple[float, float, float, float], ...]:
    return tuple((float(t), float(x), float(y), float(z)) for t, x, y, z in points)


def _trajectory_rows(
    trajectory: Trajectory,
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Return the waypoints of translation and rotation in the channels of a trajectory."""
    rows = [
        (time, *values) for time, values in zip(trajectory.times, trajectory.values, strict=True)
    ]
    translation = tuple(row[: 1 + POSITION_CHANNELS] for row in rows)
    if len(trajectory.values[0]) == POSITION_CHANNELS:
        return translation, NO_DISPLACEMENT
    return translation, tuple((row[0], *row[1 + POSITION_CHANNELS :]) for row in rows)
