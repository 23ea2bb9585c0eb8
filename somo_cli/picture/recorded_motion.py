"""The configuration at any time of a recorded run, interpolated between its rows."""

from __future__ import annotations

import dataclasses
import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.picture.drawn_parts import Configuration, start_configuration
from somo_cli.scene.model import Manipulator, Quantity, Scene
from somo_cli.scene.prescribed_motion import PosePath
from somo_cli.scene.rigid_object import RigidObject

_POSE = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")


def scene_to_draw(scene: Scene) -> Scene:
    """Return the scene recording what pictures need, and nothing else."""
    columns: tuple[Quantity, ...] = ("joint_angles", "base_pose")
    return dataclasses.replace(
        scene, columns=columns, object_quantities=("pose",), only=(), has_contact_events=False
    )


@dataclass(frozen=True, slots=True)
class RecordedMotion:
    """The columns of a run by name, with time_s, in SI, and the scene that was run."""

    scene: Scene
    columns: Mapping[str, Sequence[float]]
    _paths: dict[str, PosePath] = field(default_factory=dict, init=False, repr=False, compare=False)
    """The paths of what is not recorded, by name: each is made once, as it may have many rows."""

    @property
    def times(self) -> Sequence[float]:
        """The times of the rows [s], increasing."""
        return self.columns["time_s"]

    def required_columns(self) -> tuple[str, ...]:
        """Return the names of the columns without which the configuration is unknown."""
        names: list[str] = []
        for one in self.scene.manipulators:
            names += _angle_names(one)
            if one.base == "free":
                names += _pose_names(f"{one.name}.base_pose")
        for one_object in self.scene.objects:
            if not one_object.has_prescribed_pose:
                names += _pose_names(f"{one_object.name}.pose")
        return tuple(names)

    def at(self, time: float) -> Configuration:
        """Return the configuration at a time [s] between the first and the last row.

        Angles and positions are interpolated linearly, orientations at a constant rotation rate.
        Bases and objects that are not recorded have the pose of the scene.
        """
        start = start_configuration(self.scene)
        row, share = self._row_at(time)
        angles = tuple(
            [self._interpolated(name, row, share) for name in _angle_names(one)]
            for one in self.scene.manipulators
        )
        bases = tuple(
            self._pose(f"{one.name}.base_pose", row, share)
            or self._prescribed_pose(one, first, time)
            for one, first in zip(self.scene.manipulators, start.bases, strict=True)
        )
        objects = tuple(
            self._pose(f"{one.name}.pose", row, share) or self._prescribed_pose(one, first, time)
            for one, first in zip(self.scene.objects, start.objects, strict=True)
        )
        return Configuration(angles, bases, objects)

    def _prescribed_pose(self, one: Manipulator | RigidObject, start: Pose, time: float) -> Pose:
        """Return the pose at a time [s] of what starts there, and moves only by its motion."""
        if one.motion is None:
            return start
        if one.name not in self._paths:
            self._paths[one.name] = one.motion.path_from(start)
        return self._paths[one.name].at(time)

    def _row_at(self, time: float) -> tuple[int, float]:
        """Return the last row not after a time, and the share of the interval that has passed."""
        times = self.times
        row = min(max(bisect_right(times, time) - 1, 0), max(len(times) - 2, 0))
        if len(times) == 1:
            return row, 0.0
        share = (time - times[row]) / (times[row + 1] - times[row])
        return row, min(max(share, 0.0), 1.0)

    def _interpolated(self, name: str, row: int, share: float) -> float:
        values = self.columns[name]
        if share == 0:
            return values[row]
        return (
            values[row + 1] if share == 1 else (1 - share) * values[row] + share * values[row + 1]
        )

    def _pose(self, owner: str, row: int, share: float) -> Pose | None:
        names = _pose_names(owner)
        if not all(name in self.columns for name in names):
            return None
        x, y, z = (self._interpolated(name, row, share) for name in names[:3])
        first = [self.columns[name][row] for name in names[3:]]
        turn = first
        if share > 0:
            turn = _slerp(first, [self.columns[name][row + 1] for name in names[3:]], share)
        size = math.hypot(*turn)
        qx, qy, qz, qw = (component / size for component in turn)
        return Pose((x, y, z), geometry.rotation_from_quaternion((qx, qy, qz, qw)))


def _angle_names(one: Manipulator) -> list[str]:
    return [f"{one.name}.{joint.name}.angle_rad" for joint in one.compiled.chain.joints]


def _pose_names(owner: str) -> list[str]:
    return [f"{owner}.{part}" for part in _POSE]


def _slerp(first: Sequence[float], second: Sequence[float], share: float) -> list[float]:
    """Return the spherical interpolation of two quaternions (Shoemake, SIGGRAPH 1985)."""
    if share == 1:
        return list(second)
    dot = sum(a * b for a, b in zip(first, second, strict=True))
    sign = -1.0 if dot < 0 else 1.0
    angle = math.acos(min(abs(dot), 1.0))
    if angle < 1e-6:
        before, after = 1 - share, share
    else:
        before = math.sin((1 - share) * angle) / math.sin(angle)
        after = math.sin(share * angle) / math.sin(angle)
    return [before * a + sign * after * b for a, b in zip(first, second, strict=True)]
