"""Trajectories of sorotraj files, against what version 0.9 makes of them with numpy and scipy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import scipy.signal
from scipy.interpolate import CubicSpline, interp1d

from somo_cli.problems import has_errors
from somo_cli.scene.signals import piecewise_signal
from somo_cli.scene.sorotraj import main_part_knots, read_trajectory
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.scene_problems import problems_of, texts_and_messages

Data = dict[str, Any]
PARTS: Data = {
    "prefix": [[0, 0, 0, 0], [1, 10, 12, 14]],
    "main": [[0, 10, 12, 14], [1, 20, 0, 0], [2.5, 0, 20, 0], [5, 10, 12, 14]],
    "suffix": [[2, 10, 12, 14], [3, 0, 0, 0]],
}


def file_of(kind: str = "direct", setpoints: Data | None = None, **config: Any) -> Data:
    parts = PARTS if setpoints is None else setpoints
    return {"settings": {"traj_type": kind}, "config": {"setpoints": parts, **config}}


def waveform(shape: str, **changes: Any) -> Data:
    config = {
        "subsample_num": 90,
        "num_cycles": 2,
        "channels": [1, 1, 0, 0.5],
        "waveform_type": shape,
        "waveform_freq": 0.25,
        "waveform_max": [20, 0, 15, 5],
        "waveform_min": [0, 20, 0, 15],
    }
    return file_of("waveform", {"prefix": [[0, 0, 0, 0, 0], [2, 0, 20, 0, 0]]}, **config | changes)


def by_interpolation(
    prefix: Sequence[Sequence[float]],
    main: Sequence[Sequence[float]],
    suffix: Sequence[Sequence[float]],
    repetitions: int,
    speed: float,
    at: np.ndarray,
) -> np.ndarray:
    """What interpolator.py of 0.9 returns at some times, its steps one by one."""
    before, body, after = (np.array(part, dtype=float) for part in (prefix, main, suffix))
    use = body[1:, 0]
    times = np.concatenate([use + number * use[-1] for number in range(repetitions)])
    times = np.insert(times, 0, body[0, 0]) / speed
    values = np.vstack([body[:1, 1:], np.tile(body[1:, 1:], (repetitions, 1))])
    times = np.append(before[:, 0], times + before[-1, 0])
    times = np.append(times, after[:, 0] + times[-1])
    values = np.vstack([before[:, 1:], values, after[:, 1:]])
    steps = interp1d(times, values, bounds_error=False, fill_value=values[-1], axis=0)
    return np.array(steps(at))


@pytest.mark.parametrize(("repetitions", "speed"), [(1, 1.0), (3, 1.0), (1, 2.0), (10, 0.7)])
def test_prefix_main_and_suffix_follow_each_other(repetitions: int, speed: float) -> None:
    found = read_trajectory(file_of(), repetitions, speed)
    end = 1 + 5 * repetitions / speed + 3
    assert found.times[-1] == pytest.approx(end)
    at = np.linspace(0, end + 1, 777)
    expected = by_interpolation(
        PARTS["prefix"], PARTS["main"], PARTS["suffix"], repetitions, speed, at
    )
    for channel in range(3):
        weights = [float(channel == other) for other in range(3)]
        signal = piecewise_signal(found.weighted_sum(weights), "linear", False)
        assert [signal.at(time) for time in at] == pytest.approx(expected[:, channel], abs=1e-9)


def test_in_numbers() -> None:
    # T = prefix_end + reps * (main_end / speed) + suffix_end; the first main knot comes once
    found = read_trajectory(file_of(), repetitions=2, speed_factor=2)
    assert found.times == pytest.approx([0, 1, 1.5, 2.25, 3.5, 4, 4.75, 6, 8, 9])
    assert [row[0] for row in found.values] == [0, 10, 20, 0, 10, 20, 0, 10, 10, 0]


def test_parts_that_meet_with_different_values_jump_after_they_meet() -> None:
    parts = {"prefix": [[0, 0], [1, 5]], "main": [[0, 7], [1, 8]], "suffix": [[0, 1], [1, 0]]}
    signal = piecewise_signal(
        read_trajectory(file_of(setpoints=parts)).weighted_sum([1.0]), "linear", False
    )
    at = np.array([0.5, 1.0, 1.0 + 1e-9, 1.5, 2.0, 2.0 + 1e-9, 2.5])
    expected = by_interpolation(parts["prefix"], parts["main"], parts["suffix"], 1, 1.0, at)
    assert [signal.at(time) for time in at] == pytest.approx(expected[:, 0], abs=1e-6)


def test_what_is_missing_is_left_out() -> None:
    for none in ({}, {"prefix": None, "suffix": None}, {"prefix": [], "suffix": []}):
        found = read_trajectory(file_of(setpoints={"main": PARTS["main"], **none}), repetitions=2)
        assert found.times == (0, 1, 2.5, 5, 6, 7.5, 10)


@pytest.mark.parametrize(
    ("invert", "signs"), [(True, (-1, -1, -1)), (False, (1, 1, 1)), ([0, 2], (-1, 1, -1))]
)
def test_signs_are_turned(invert: bool | list[int], signs: tuple[int, ...]) -> None:
    plain, turned = read_trajectory(file_of()), read_trajectory(file_of(), invert=invert)
    assert turned.times == plain.times
    assert np.array(turned.values) == pytest.approx(np.array(plain.values) * signs)


def test_straight_lines_are_the_same_sampled_or_not() -> None:
    linear = file_of("interp", interp_type="linear", subsample_num=90)
    assert read_trajectory(linear) == read_trajectory(file_of())
    assert read_trajectory(file_of("interp", interp_type="none")) == read_trajectory(file_of())


def test_a_cubic_main_part_is_sampled_from_a_periodic_spline() -> None:
    samples = 37
    found = main_part_knots(file_of("interp", interp_type="cubic", subsample_num=samples))
    knots = np.array(PARTS["main"])
    times = np.linspace(knots[0, 0], knots[-1, 0], samples + 1)
    times[[np.argmin(np.abs(times - time)) for time in knots[:, 0]]] = knots[:, 0]
    spline = CubicSpline(knots[:, 0], knots[:, 1:], bc_type="periodic")
    assert [time for time, _ in found] == pytest.approx(times)
    assert np.array([row for _, row in found]) == pytest.approx(spline(times), abs=1e-9)


@pytest.mark.parametrize("shape", ["square-sampled", "sin", "cos-up", "cos-down"])
def test_sampled_wave_forms(shape: str) -> None:
    data = waveform(shape)
    found = main_part_knots(data)
    turns = np.linspace(0, 2, 91)
    unit = {
        "square-sampled": scipy.signal.square(2 * np.pi * turns + 1e-9),
        "sin": np.sin(2 * np.pi * turns),
        "cos-up": np.cos(2 * np.pi * turns),
        "cos-down": -np.cos(2 * np.pi * turns),
    }[shape]
    assert [time for time, _ in found] == pytest.approx(turns / 0.25)
    # (max - min) / 2 and (max + min) / 2, times the channel
    expected = np.outer(unit, [10, -10, 0, -2.5]) + np.array([10, 10, 0, 5])
    assert np.array([row for _, row in found]) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("shape", "turns", "levels"),
    [
        ("square", [0, 0.49, 0.5, 0.99, 1, 1.49, 1.5, 1.99, 2], [-1, -1, 1, 1] * 2 + [-1]),
        ("triangle", [0, 0.5, 1, 1.5, 2], [-1, 1, -1, 1, -1]),
        ("sawtooth-f", [0, 0.99, 1, 1.99, 2], [-1, 1, -1, 1, -1]),
        ("sawtooth-r", [0, 0.01, 1, 1.01, 2], [-1, 1, -1, 1, -1]),
    ],
)
def test_wave_forms_by_their_corners(shape: str, turns: list[float], levels: list[float]) -> None:
    found = main_part_knots(waveform(shape))
    assert [time for time, _ in found] == pytest.approx([turn / 0.25 for turn in turns])
    assert [row[0] for _, row in found] == pytest.approx([10 + 10 * level for level in levels])


def sorotraj_problems(data: Data, **of_entry: Any) -> list[tuple[str, str]]:
    """Return every problem of a scene with this trajectory: the text at the place, the message."""
    entry = {"name": "gait", "sorotraj": data, **of_entry}
    scene = {
        "trajectories": [entry],
        "manipulators": [{"definition": manipulator(actuator(2, X))}],
    }
    return texts_and_messages(scene)


@pytest.mark.parametrize(
    "data",
    [
        file_of(),
        file_of("interp", interp_type="cubic", subsample_num=9),
        waveform("sin"),
        waveform("square", subsample_num=None),
    ],
)
def test_valid_files_have_no_problems(data: Data) -> None:
    assert sorotraj_problems(data) == []


@pytest.mark.parametrize(
    ("data", "of_entry", "messages"),
    [
        (
            file_of(setpoints={"main": [[0, 1], [1, 2], [1, 3]], "prefix": [[0, 1, 2]]}),
            {},
            [
                "time 1 s does not come after 1 s",
                "2 channels in this knot, 1 in the main part",
            ],
        ),
        (file_of(setpoints={"main": [[0, 1]]}), {}, ["the main part has 1 knots"]),
        (file_of(setpoints={}), {}, ["the main part has 0 knots"]),
        (
            file_of("interp", {"main": [[0, 1], [1, 2]]}, interp_type="cubic"),
            {},
            ["missing key 'subsample_num'", "a cubic main part must end with the values it starts "
             "with"],
        ),
        (
            file_of("waveform", {}, waveform_type="sin", channels=[1]),
            {},
            [
                "missing key 'waveform_freq'",
                "missing key 'waveform_max'",
                "missing key 'waveform_min'",
                "missing key 'num_cycles'",
                "missing key 'subsample_num'",
            ],
        ),
        (
            waveform("triangle", waveform_max=[1, 2]),
            {},
            [
                "the lists have different numbers of channels: waveform_max 2, waveform_min 4, "
                "channels 4"
            ],
        ),
        (
            file_of("waveform", {}, waveform_type="square", waveform_freq=1, num_cycles=2,
                    waveform_max=[1, 2], waveform_min=[0, 0, 0, 0]),
            {},
            [
                "missing key 'channels'",
                "the lists have different numbers of channels: waveform_max 2, waveform_min 4",
            ],
        ),
        (file_of(), {"invert": [0, 3]}, ["there is no channel 3"]),
    ],
)  # fmt: skip
def test_problems_are_reported_at_once(data: Data, of_entry: Data, messages: list[str]) -> None:
    assert sorted(message for _, message in sorotraj_problems(data, **of_entry)) == sorted(messages)


def test_a_mix_has_one_weight_per_channel() -> None:
    def said(**of_drive: Any) -> list[str]:
        scene = {
            "trajectories": [{"name": "gait", "sorotraj": file_of()}],
            "manipulators": [
                {
                    "definition": manipulator(actuator(2, X)),
                    "actuation": [{"actuator": 0, "axis": 0, **of_drive}],
                }
            ],
        }
        problems = problems_of(scene)
        assert has_errors(problems) == bool(problems)
        return [problem.message for problem in problems]

    assert said(trajectory="gait", mix=[1, 2, 3]) == []
    assert said(trajectory="gait", mix=[1, 2]) == ["mix has 2 weights for the 3 channels of 'gait'"]
    assert said(trajectory="gate", mix=[1]) == ["there is no trajectory 'gate'"]
    assert said(trajectory="gait") == ["a trajectory needs a mix"]
    assert said(torque=1, mix=[1]) == ["mix has no meaning beside a constant torque"]


def test_a_part_of_one_knot_at_time_zero_takes_no_time() -> None:
    parts = {"prefix": [[0, 0]], "main": [[0, 1], [1, 2], [2, 1]], "suffix": [[0, 4]]}
    whole = read_trajectory(file_of(setpoints=parts))
    assert whole.times[:3] == (0.0, 1.0, 2.0)
    assert whole.values == ((1.0,), (2.0,), (1.0,), (4.0,))
    signal = piecewise_signal(whole.weighted_sum([1]), "linear", False)
    assert [signal.at(t) for t in (0.0, 0.5, 2.0, 2.1)] == pytest.approx([1, 1.5, 1, 4])
