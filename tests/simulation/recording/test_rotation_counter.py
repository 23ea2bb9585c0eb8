"""Turns counted beyond full ones: about one axis, at any tilt, and round a cone."""

from __future__ import annotations

import math

import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix
from somo_cli.simulation.recording.rotation_counter import RotationCounter

TILTED = geometry.rotation_from_rpy((1.2, math.pi / 2, -0.4))


@pytest.mark.parametrize("start", [geometry.IDENTITY, TILTED])
@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.0, -0.8)])
@pytest.mark.parametrize("sign", [1, -1])
def test_full_turns_about_one_axis_are_counted(
    start: Matrix, axis: tuple[float, float, float], sign: int
) -> None:
    def at(angle: float) -> Matrix:
        return geometry.multiply(geometry.rotation_about(axis, angle), start)

    counter = RotationCounter(at(0))
    for step in range(1, 101):
        counter.update(at(sign * 0.3 * step))
    turned = [sign * 30.5 * component for component in axis]  # nearly five turns
    assert counter.at(at(sign * 30.5)) == pytest.approx(turned, abs=1e-12)


def test_it_does_not_matter_how_often_one_asks() -> None:
    counters = RotationCounter(TILTED), RotationCounter(TILTED)
    for step in range(1, 40):
        rotation = geometry.multiply(geometry.rotation_from_rpy((0.0, 0.01, 0.2 * step)), TILTED)
        counters[1].at(rotation)
        if step % 8 == 0:
            for one in counters:
                one.update(rotation)
        assert counters[0].at(rotation) == counters[1].at(rotation)


def test_an_axis_round_a_cone_adds_the_angle_of_the_cone() -> None:
    # a body that leans by a constant angle while its lean goes round once, without spin of its own
    # about the lean, is back where it was; its angular velocity about z has an integral all the
    # same, the solid angle 2π(1 - cos lean)
    lean, count = 0.5, 4000
    poses = [
        geometry.rotation_about((math.cos(path), math.sin(path), 0.0), lean)
        for path in (2 * math.pi * step / count for step in range(count + 1))
    ]
    counter = RotationCounter(poses[0])
    for pose in poses:
        counter.update(pose)
    x, y, z = counter.at(poses[-1])
    assert (x, y) == pytest.approx((0, 0), abs=1e-9)
    assert abs(z) == pytest.approx(2 * math.pi * (1 - math.cos(lean)), rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-7, 1.0, 3.1])
def test_the_vector_of_a_rotation(angle: float) -> None:
    axis = (2 / 3, -1 / 3, 2 / 3)
    found = geometry.rotation_vector(geometry.rotation_about(axis, angle))
    assert found == pytest.approx([angle * one for one in axis], rel=1e-9, abs=1e-15)
