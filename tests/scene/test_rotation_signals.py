"""Rotations over time: roll, pitch and yaw as numbers, quaternions as directions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.scene.prescribed_motion import component_signals
from somo_cli.scene.rotation_signals import QuaternionSignal, RollPitchYawSignal, RotationSignal


def at(signal: RotationSignal, time: float) -> np.ndarray:
    found = signal.rotation([one.at(time) for one in signal.components])
    return np.eye(3) if found is None else np.array(found)


def quaternions(points: list[list[float]], interpolation: str = "linear") -> QuaternionSignal:
    x, y, z, w = component_signals(points, interpolation, False)  # type: ignore[arg-type]
    return QuaternionSignal((x, y, z, w))


def about_z(angle: float) -> list[float]:
    return [0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)]


def test_quaternions_are_met_at_their_times_and_the_way_is_that_of_a_slerp() -> None:
    signal = quaternions([[0.0, *about_z(0.0)], [1.0, *about_z(0.8)], [2.0, *about_z(0.2)]])
    for time, angle in ((0.0, 0.0), (0.5, 0.4), (1.0, 0.8), (1.5, 0.5), (2.0, 0.2), (9.0, 0.2)):
        expected = geometry.rotation_from_rpy((0, 0, angle))
        assert at(signal, time) == pytest.approx(np.array(expected), abs=1e-12)


def test_the_rate_between_quaternions_varies_by_as_much_as_is_said() -> None:
    signal = quaternions([[0.0, *about_z(0.0)], [1.0, *about_z(math.pi / 4)]])
    angles = [math.atan2(at(signal, t)[1, 0], at(signal, t)[0, 0]) for t in np.linspace(0, 1, 501)]
    rates = np.diff(angles) / (math.pi / 4) * 500
    assert rates.max() - rates.min() == pytest.approx(0.04, abs=0.01)


def test_it_turns_through_a_pitch_of_a_quarter_turn_where_angles_are_singular() -> None:
    """A turn about y, then about x at a pitch of π/2: roll and yaw would jump there."""
    pitches = [[t, 0.0, math.sin(t / 2), 0.0, math.cos(t / 2)] for t in np.linspace(0, 3, 301)]
    signal = quaternions(pitches, "cubic")
    expected = geometry.rotation_from_rpy((0, 1.57, 0))
    assert at(signal, 1.57) == pytest.approx(np.array(expected), abs=1e-6)
    steps = [
        geometry.rotation_vector(
            geometry.multiply(
                tuple(map(tuple, at(signal, t + 1e-3).tolist())),  # type: ignore[arg-type]
                geometry.transposed(tuple(map(tuple, at(signal, t).tolist()))),  # type: ignore[arg-type]
            )
        )
        for t in np.linspace(1.5, 1.65, 40)
    ]
    assert np.array(steps) == pytest.approx(np.array([[0, 1e-3, 0]] * 40), abs=2e-6)


@pytest.mark.parametrize("start", [0.0, 0.7])
def test_small_angles_are_those_about_the_axes_of_the_world(start: float) -> None:
    first = geometry.quaternion_from_rotation(geometry.rotation_from_rpy((start, start / 2, 0)))
    turn = geometry.rotation_from_rpy((1e-3, -2e-3, 3e-3))
    second = geometry.quaternion_from_rotation(
        geometry.multiply(turn, geometry.rotation_from_rpy((start, start / 2, 0)))
    )
    signal = quaternions([[0.0, *first], [1.0, *second]])
    found = [one.at(1.0) - one.at(0.0) for one in signal.small_angles()]
    assert found == pytest.approx([1e-3, -2e-3, 3e-3], abs=5e-6)
    x, y, z = component_signals([[0, 0, 0, 0], [1, 1e-3, -2e-3, 3e-3]], "linear", False)
    own = RollPitchYawSignal((x, y, z)).small_angles()
    assert [one.at(1.0) for one in own] == [1e-3, -2e-3, 3e-3]
