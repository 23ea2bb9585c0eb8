"""Read the torques that drive the joints of a manipulator over time."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from somo_cli.manipulator.definition import Definition
from somo_cli.scene import signals
from somo_cli.scene.signals import Interpolation, Signal, Wave
from somo_cli.scene.sorotraj import Trajectory

EVERY_ONE = "all"
"""Stands for the list of all actuators or limbs, in their order."""


@dataclass(frozen=True, slots=True)
class WaypointProfile:
    """A profile through (time [s], value) points in order of time.

    After the last point the value stays constant or, with `repeat`, starts again at time zero.
    """

    points: tuple[tuple[float, float], ...]
    interpolation: Interpolation = "linear"
    repeat: bool = False

    def scaled(self, factor: float) -> WaypointProfile:
        """Return the profile with every value times a factor."""
        points = tuple((time, value * factor) for time, value in self.points)
        return dataclasses.replace(self, points=points)

    @property
    def constant_value(self) -> float | None:
        """The value if it never changes, else None."""
        return self.points[0][1] if len(self.points) == 1 else None

    @property
    def final_value(self) -> float | None:
        """The constant value after the last point, None if the profile repeats."""
        return None if self.repeat else self.points[-1][1]

    def signal(self) -> Signal:
        """Return the value over time."""
        return signals.piecewise_signal(self.points, self.interpolation, self.repeat)


@dataclass(frozen=True, slots=True)
class WaveProfile:
    """A profile that is a wave."""

    wave: Wave

    def scaled(self, factor: float) -> WaveProfile:
        """Return the profile with amplitude and offset times a factor."""
        wave = self.wave
        return WaveProfile(
            dataclasses.replace(
                wave, amplitude=wave.amplitude * factor, offset=wave.offset * factor
            )
        )

    @property
    def constant_value(self) -> float | None:
        """The value if it never changes, else None."""
        return self.wave.offset if self.wave.amplitude == 0 else None

    @property
    def final_value(self) -> float | None:
        """The value if it never changes, else None: a wave does not end."""
        return self.constant_value

    def signal(self) -> Signal:
        """Return the value over time."""
        return self.wave


ActuationProfile: TypeAlias = WaypointProfile | WaveProfile


@dataclass(frozen=True, slots=True)
class Actuation:
    """A torque [N·m] over time on every joint of one actuator and axis."""

    actuator: int
    axis: int
    profile: ActuationProfile


class AmbiguousTorquePerPressure(ValueError):
    """The joints of one axis have different torques per pressure."""


def torque_per_pressure(definition: Definition, actuator: int, axis: int) -> float | None:
    """Return the torque per pressure of every joint of an axis [N·m/Pa], None if it is not given.

    Raises AmbiguousTorquePerPressure.
    """
    one = definition.actuators[actuator]
    pairs = zip(one.channels, one.joints, strict=True)
    found = {joint.torque_per_pressure for channel, joint in pairs if channel == axis}
    if len(found) > 1:
        raise AmbiguousTorquePerPressure
    return found.pop()


def driven_actuators(data: Mapping[str, Any], definition: Definition) -> tuple[int, ...]:
    """Return the numbers of the actuators that an entry drives, in the order of a wave.

    In an assembly, numbers count the actuators of all limbs; the order is that of the entry.
    """
    if not definition.limbs:
        return driven_actuator_numbers(data, len(definition.actuators))
    return tuple(
        definition.actuators_of(limb)[number]
        for limb in driven_limbs(data, definition)
        for number in driven_actuator_numbers(data, len(definition.actuators_of(limb)))
    )


def driven_limbs(data: Mapping[str, Any], definition: Definition) -> tuple[str, ...]:
    """Return the names of the limbs that an entry drives, in the order of a wave."""
    if "limbs" not in data:
        return (str(data["limb"]),)
    if data["limbs"] == EVERY_ONE:
        return tuple(limb.name for limb in definition.limbs)
    return tuple(str(name) for name in data["limbs"])


def driven_actuator_numbers(data: Mapping[str, Any], count: int) -> tuple[int, ...]:
    """Return the numbers of the actuators that an entry drives, of the `count` of one backbone."""
    if "actuators" not in data:
        return (int(data["actuator"]),)
    if data["actuators"] == EVERY_ONE:
        return tuple(range(count))
    return tuple(int(number) for number in data["actuators"])


def is_pressure(data: Mapping[str, Any]) -> bool:
    """Return whether the values of an entry are pressures [Pa], not torques [N·m]."""
    return "pressure" in data or data.get("input") == "pressure"


def read_actuation(
    data: Mapping[str, Any], definition: Definition, trajectories: Mapping[str, Trajectory]
) -> Iterator[Actuation]:
    """Yield the torque [N·m] over time for each actuator of an entry without errors."""
    axis = int(data["axis"])
    for wave_index, actuator in enumerate(driven_actuators(data, definition)):
        profile = _profile(data, wave_index, trajectories)
        if is_pressure(data):
            profile = profile.scaled(torque_per_pressure(definition, actuator, axis) or 0.0)
        yield Actuation(actuator, axis, profile)


def _profile(
    data: Mapping[str, Any], wave_index: int, trajectories: Mapping[str, Trajectory]
) -> ActuationProfile:
    constant = data.get("torque", data.get("pressure"))
    if constant is not None:
        return WaypointProfile(((0.0, float(constant)),))
    if "wave" in data:
        return WaveProfile(_wave(data["wave"], wave_index))
    if "trajectory" in data:
        weighted_sum = trajectories[data["trajectory"]].weighted_sum(
            [float(weight) for weight in data["mix"]]
        )
        return WaypointProfile(weighted_sum)
    return WaypointProfile(
        points=tuple((float(time), float(value)) for time, value in data["waypoints"]),
        interpolation=data.get("interpolation", "linear"),
        repeat=bool(data.get("repeat", False)),
    )


def _wave(data: Mapping[str, Any], wave_index: int) -> Wave:
    return Wave(
        shape=data.get("shape", "sine"),
        amplitude=float(data["amplitude"]),
        frequency=float(data["frequency"]),
        phase=float(data.get("phase", 0)) - wave_index * float(data.get("lag", 0)),
        offset=float(data.get("offset", 0)),
        rise=float(data.get("rise", 0.25)),
    )
