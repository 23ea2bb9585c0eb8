"""Torque over time against its definition and against scipy's own splines."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from somo_cli.scene.signals import Interpolation, Wave, WaveShape, piecewise_signal

POINTS = [(0.5, 1.0), (1.0, -2.0), (2.5, 3.0), (3.0, 3.0), (4.0, 0.25)]
ROUND = [(0.0, 1.0), (0.3, -2.0), (1.0, 4.0), (1.5, 1.0)]
KINDS: tuple[Interpolation, ...] = ("step", "linear", "cubic")


@pytest.mark.parametrize("kind", KINDS)
def test_every_waypoint_is_met(kind: Interpolation) -> None:
    signal = piecewise_signal(POINTS, kind, repeat=False)
    assert [signal.at(time) for time, _ in POINTS] == pytest.approx([value for _, value in POINTS])


@pytest.mark.parametrize("kind", KINDS)
def test_the_ends_are_held(kind: Interpolation) -> None:
    signal = piecewise_signal(POINTS, kind, repeat=False)
    assert [signal.at(time) for time in (-1e9, 0.0, 0.499)] == [1.0, 1.0, 1.0]
    assert [signal.at(time) for time in (4.0, 4.001, 1e9)] == [0.25, 0.25, 0.25]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("repeat", [False, True])
def test_a_single_point_is_constant(kind: Interpolation, repeat: bool) -> None:
    signal = piecewise_signal([(2.0, 7.0)], kind, repeat)
    assert [signal.at(time) for time in (-3.0, 0.0, 2.0, 5.0)] == [7.0] * 4
    assert signal.constant_until(0.0) == math.inf


def test_a_step_holds_until_the_next_point() -> None:
    signal = piecewise_signal(POINTS, "step", repeat=False)
    times = (0.5, 0.999, 1.0, 1.7, 2.499, 2.5, 3.2, 3.999, 4.0)
    assert [signal.at(time) for time in times] == [1, 1, -2, -2, -2, 3, 3, 3, 0.25]


def test_linear_is_that_of_numpy() -> None:
    signal = piecewise_signal(POINTS, "linear", repeat=False)
    times = np.linspace(-1, 6, 701)
    expected = np.interp(times, *zip(*POINTS, strict=True))
    assert np.allclose([signal.at(time) for time in times], expected, rtol=0, atol=1e-14)


def test_cubic_is_the_clamped_spline() -> None:
    signal = piecewise_signal(POINTS, "cubic", repeat=False)
    spline = CubicSpline(*zip(*POINTS, strict=True), bc_type="clamped")
    times = np.linspace(0.5, 4.0, 701)
    assert np.allclose([signal.at(time) for time in times], spline(times), rtol=0, atol=1e-13)


def test_cubic_leaves_and_reaches_the_held_ends_without_a_kink() -> None:
    signal = piecewise_signal(POINTS, "cubic", repeat=False)
    for end in (0.5, 4.0):
        slopes = [(signal.at(end + d) - signal.at(end)) / d for d in (-1e-6, 1e-6)]
        assert slopes == pytest.approx([0.0, 0.0], abs=1e-4)


def test_a_repeated_cubic_is_the_periodic_spline() -> None:
    signal = piecewise_signal(ROUND, "cubic", repeat=True)
    spline = CubicSpline(*zip(*ROUND, strict=True), bc_type="periodic")
    times = np.linspace(0.0, 1.5, 500, endpoint=False)
    assert np.allclose([signal.at(time) for time in times], spline(times), rtol=0, atol=1e-12)


def test_a_straight_line_of_two_points_is_smooth_as_a_cubic() -> None:
    signal = piecewise_signal([(0.0, 0.0), (2.0, 1.0)], "cubic", repeat=False)
    # the only cubic that is level at both ends: 3 s² - 2 s³
    assert [signal.at(2 * s) for s in (0.25, 0.5, 0.75)] == pytest.approx([0.15625, 0.5, 0.84375])


@pytest.mark.parametrize("kind", KINDS)
def test_a_repeated_signal_has_the_time_of_its_last_point_as_period(kind: Interpolation) -> None:
    signal = piecewise_signal(ROUND, kind, repeat=True)
    for time in np.linspace(0.0, 1.49, 50):
        now = signal.at(float(time))
        assert [signal.at(time + n * 1.5) for n in (-2, 1, 7)] == pytest.approx(
            [now] * 3, abs=1e-12
        )


def test_a_repeated_signal_that_starts_late_holds_its_first_value_in_every_period() -> None:
    signal = piecewise_signal([(0.5, 1.0), (1.0, 2.0)], "linear", repeat=True)
    assert [signal.at(time) for time in (0.0, 0.25, 0.75, 1.0, 1.25, 1.75)] == [
        1, 1, 1.5, 1, 1, 1.5,
    ]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_steady_until_returns_how_long_the_value_stays(kind: Interpolation) -> None:
    signal = piecewise_signal(POINTS, kind, repeat=False)
    assert signal.constant_until(0.2) == 0.5
    assert signal.constant_until(4.0) == math.inf
    assert signal.constant_until(9.0) == math.inf
    for time in np.linspace(-1, 5, 601):
        end = min(signal.constant_until(time), 10.0)
        assert end >= time
        between = {signal.at(moment) for moment in np.linspace(time, end, 20, endpoint=False)}
        assert between == {signal.at(time)}


def test_steady_until_between_points() -> None:
    step = piecewise_signal(POINTS, "step", repeat=False)
    assert [step.constant_until(time) for time in (0.5, 0.9, 1.0, 2.6)] == [1.0, 1.0, 2.5, 3.0]
    linear = piecewise_signal(POINTS, "linear", repeat=False)
    assert [linear.constant_until(time) for time in (0.5, 0.9, 2.5, 2.6)] == [0.5, 0.9, 3.0, 3.0]


def test_steady_until_of_a_repeated_signal() -> None:
    assert piecewise_signal(ROUND, "step", repeat=True).constant_until(0.1) == 0.1
    assert (
        piecewise_signal([(0.0, 3.0), (1.0, 3.0)], "linear", repeat=True).constant_until(5.0)
        == math.inf
    )


@pytest.mark.parametrize(
    ("shape", "values"),
    # at eighths of a period
    [
        ("sine", [0, 2**-0.5, 1, 2**-0.5, 0, -(2**-0.5), -1, -(2**-0.5)]),
        ("triangle", [0, 0.5, 1, 0.5, 0, -0.5, -1, -0.5]),
        ("square", [1, 1, 1, 1, -1, -1, -1, -1]),
        ("trapezoid", [0, 1, 1, 1, 0, -1, -1, -1]),
    ],
)
def test_the_shapes_of_waves(shape: WaveShape, values: list[float]) -> None:
    wave = Wave(shape, amplitude=3, frequency=0.25, offset=5)
    times = [0.5 * number for number in range(16)]
    assert [wave.at(time) for time in times] == pytest.approx([5 + 3 * v for v in 2 * values])
    # a quarter of a period on
    later = Wave(shape, amplitude=3, frequency=0.25, phase=math.pi / 2, offset=5)
    assert [later.at(time) for time in times[:6]] == pytest.approx(
        [5 + 3 * v for v in (2 * values)[2:8]]
    )


def test_a_trapezoid_takes_its_time() -> None:
    slow = Wave("trapezoid", amplitude=1, frequency=1, rise=0.5)
    triangle = Wave("triangle", amplitude=1, frequency=1)
    times = [0.01 * number for number in range(100)]
    assert [slow.at(time) for time in times] == pytest.approx([triangle.at(t) for t in times])
    steep = Wave("trapezoid", amplitude=1, frequency=1, rise=0.1)
    assert [steep.at(time) for time in (0.025, 0.05, 0.45, 0.475)] == pytest.approx(
        [0.5, 1, 1, 0.5]
    )


def test_a_square_wave_is_steady_in_between() -> None:
    wave = Wave("square", amplitude=1, frequency=2)
    assert wave.constant_until(0.1) == pytest.approx(0.25)
    assert wave.constant_until(0.3) == pytest.approx(0.5)
    assert wave.at(wave.constant_until(0.1)) == wave.at(0.1)
    for shape in ("sine", "triangle", "trapezoid"):
        assert Wave(shape, 1, 2).constant_until(0.1) == 0.1
        assert Wave(shape, 0, 2).constant_until(0.1) == math.inf


@pytest.mark.parametrize("interpolation", ["linear", "step"])
def test_a_jump_that_no_float_has_a_slope_for_is_a_jump(interpolation: Interpolation) -> None:
    signal = piecewise_signal([(0.0, 0.0), (5e-324, 1.0), (1.0, 1.0)], interpolation, False)
    assert [signal.at(0.0), signal.at(1e-9), signal.at(2.0)] == [0.0, 1.0, 1.0]
