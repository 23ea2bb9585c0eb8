"""Frequency and damping of decays that are known, and what is no decay."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from somo_cli.arrays import Array
from somo_cli.calibration.ring_down import NoRingDown, RingDown, ring_down

FREQUENCY = 7.3


def even(ratio: float, periods: float, points: int, start: float = 3.0) -> Array:
    """Return even times over so many periods of the damped swing, shape (points,)."""
    damped = FREQUENCY * math.sqrt(1 - ratio**2)
    return start + np.linspace(0, periods * 2 * math.pi / damped, points)


def swing(times: Array, ratio: float, phase: float = 1.0, multiple: float = 1.0) -> Array:
    """Return a decay with an envelope of 1 at the first instant, shape (n,)."""
    t = times - times[0]
    damped = FREQUENCY * math.sqrt(1 - ratio**2)
    return np.asarray(np.exp(-ratio * FREQUENCY * t) * np.cos(multiple * damped * t + phase))


def noise(points: int, seed: int) -> Array:
    return np.random.default_rng(seed).standard_normal(points)


def assert_exact(found: RingDown, ratio: float, rel: float = 1e-9) -> None:
    assert found.frequency == pytest.approx(FREQUENCY, rel=rel)
    assert found.ratio == pytest.approx(ratio, rel=rel)
    assert found.decay == pytest.approx(ratio * FREQUENCY, rel=rel)


@pytest.mark.moderate
@pytest.mark.parametrize("ratio", [0.001, 0.02, 0.2, 0.6, 0.7])
@pytest.mark.parametrize("periods", [1.5, 4.0, 30.0, 200.0])
@pytest.mark.parametrize("phase", [0.0, 1.0, 2.5, 4.5])  # where in the swing the record starts
def test_an_exact_decay_is_recovered(ratio: float, periods: float, phase: float) -> None:
    times = even(ratio, periods, int(20 * periods))
    found = ring_down(times, 0.02 + 0.005 * swing(times, ratio, phase))
    assert_exact(found, ratio)
    assert found.rest == pytest.approx(0.02, rel=1e-9)
    assert found.amplitude == pytest.approx(0.005, rel=1e-9)
    assert found.periods == pytest.approx(periods, rel=1e-9)
    assert found.explained == pytest.approx(1.0, abs=1e-12)
    assert found.residual < 1e-12
    assert found.frequency_error < 1e-9 * FREQUENCY


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "periods", "points"),
    [(0.001, 50, 1000), (0.03, 1.5, 60), (0.1, 6, 200), (0.6, 3, 90)],
)
def test_noise_is_within_the_confidence_interval_as_often_as_it_says(
    ratio: float, periods: float, points: int
) -> None:
    times = even(ratio, periods, points)
    inside = np.zeros(3, dtype=int)
    for seed in range(100):
        found = ring_down(times, swing(times, ratio) + 0.05 * noise(points, seed))
        inside += [
            abs(found.frequency - FREQUENCY) <= found.frequency_error,
            abs(found.decay - ratio * FREQUENCY) <= found.decay_error,
            abs(found.ratio - ratio) <= found.ratio_error,
        ]
        assert found.residual == pytest.approx(0.05, rel=0.5)
    assert inside.min() >= 88


def test_the_errors_shrink_with_the_noise() -> None:
    times = even(0.05, 10, 300)
    loud, quiet = (ring_down(times, swing(times, 0.05) + s * noise(300, 1)) for s in (0.05, 0.005))
    assert quiet.frequency_error == pytest.approx(loud.frequency_error / 10, rel=0.05)
    assert quiet.decay_error == pytest.approx(loud.decay_error / 10, rel=0.05)
    # at light damping ζ = σ/ω, and ω is known far better
    assert quiet.ratio_error == pytest.approx(quiet.decay_error / FREQUENCY, rel=0.01)


def test_times_need_not_be_even() -> None:
    for seed in range(20):
        times = np.sort(np.random.default_rng(seed).uniform(0, 6, 70))
        assert_exact(ring_down(times, swing(times, 0.04)), 0.04)


def test_a_gap_in_the_record_does_no_harm() -> None:
    times = even(0.02, 20, 500)
    times = times[(times < 5.5) | (times > 9.0)]
    assert_exact(ring_down(times, swing(times, 0.02)), 0.02)


def test_an_offset_a_hundred_times_the_amplitude_does_no_harm() -> None:
    times = even(0.01, 12, 400)
    found = ring_down(times, 100 + swing(times, 0.01))
    assert_exact(found, 0.01)
    assert found.rest == pytest.approx(100, rel=1e-12)


def test_the_unit_and_the_origin_of_time_do_not_matter() -> None:
    times = even(0.1, 5, 100)
    values = swing(times, 0.1) + 0.01 * noise(100, 4)
    one, other = ring_down(times, values), ring_down(1e-3 * times - 7, -1e6 * values)
    assert other.frequency == pytest.approx(1e3 * one.frequency, rel=1e-7)
    assert other.decay_error == pytest.approx(1e3 * one.decay_error, rel=1e-5)
    assert other.ratio == pytest.approx(one.ratio, rel=1e-6)
    assert other.amplitude == pytest.approx(1e6 * one.amplitude, rel=1e-6)


@pytest.mark.parametrize(
    ("ratio", "of_frequency", "of_ratio"),
    [(0.02, 2e-5, 2e-3), (0.1, 3e-4, 4e-3), (0.3, 3e-3, 2e-2)],
)
def test_a_second_mode_of_five_percent_errs_by_little(
    ratio: float, of_frequency: float, of_ratio: float
) -> None:
    """Six times as fast; with the same decay per second the errors are 9e-6 and 1e-3 at ζ = 0.02,
    2e-4 and 3e-3 at 0.1, 2e-3 and 1.5e-2 at 0.3: more where few periods share the record."""
    times = even(ratio, 10, 500)
    found = ring_down(times, swing(times, ratio) + 0.05 * swing(times, ratio, 0.0, multiple=6))
    assert 0.1 * of_frequency < abs(found.frequency / FREQUENCY - 1) < of_frequency
    assert 0.1 * of_ratio < abs(found.ratio / ratio - 1) < of_ratio


def test_an_undamped_swing_is_no_growth() -> None:
    times = even(0.0, 20, 400)
    found = ring_down(times, swing(times, 0.0))
    assert found.decay == pytest.approx(0.0, abs=1e-12)
    noisy = [ring_down(times, swing(times, 0.0) + 0.05 * noise(400, seed)) for seed in range(5)]
    assert max(abs(one.decay) for one in noisy) < 0.01


def refusal(times: Array, values: Array) -> str:
    with pytest.raises(NoRingDown) as caught:
        ring_down(times, values)
    return str(caught.value)


T = np.arange(50.0)


@pytest.mark.parametrize(
    ("times", "values", "message"),
    [
        (T[:7], T[:7], "the record has 7 points: a fit needs 8 or more"),
        (T, T[:9], "there are times of shape (50,), values of shape (9,)"),
        (T, np.where(T == 4, math.nan, T), "value 5 of the record is nan"),
        (np.where(T == 49, math.inf, T), T, "time 50 of the record is inf"),
        (
            np.where(T == 9, 8.0, T),
            T,
            "time 10 of the record, 8 s, is not after the time before it, 8 s",
        ),
        (T, 0 * T + 0.3, "the values are constant, 0.3: there is no swing in the record"),
        (T, 0 * T, "the values are constant, 0: there is no swing in the record"),
        (
            T,
            np.exp(-T / 8),
            "the values return to rest without a swing: the damping ratio is 1",
        ),
    ],
)
def test_data_without_a_decay_are_refused(times: Array, values: Array, message: str) -> None:
    assert refusal(times, values) == message


def test_half_a_period_is_refused() -> None:
    times = even(0.02, 0.5, 100)
    assert refusal(times, swing(times, 0.02)) == (
        "the record holds 0.5 periods of a swing: a fit needs one or more; record for longer"
    )


def test_three_samples_per_period_are_refused() -> None:
    times = even(0.01, 20, 61)
    assert refusal(times, swing(times, 0.01)) == (
        "the record has 3 samples per period: a fit needs 4 or more, because with fewer the "
        "frequency is ambiguous; sample faster"
    )


@pytest.mark.parametrize("ratio", [-0.005, -0.3])
def test_a_growing_swing_is_refused(ratio: float) -> None:
    times = even(ratio, 10, 400)
    assert refusal(times, swing(times, ratio)) == (
        f"the swing grows, by e^({-ratio * FREQUENCY:.3g} t), and does not decay: something drives "
        "it; cut the record with --from/--until, or choose another column"
    )


@pytest.mark.parametrize("seed", range(5))
def test_noise_alone_is_refused(seed: int) -> None:
    message = refusal(even(0.0, 10, 200), noise(200, seed))
    found = re.fullmatch(
        "the record does not look like one decaying swing, which explains only ([0-9]+) % of the "
        "data; cut the record with --from/--until, or choose another column",
        message,
    )
    assert found is not None, message
    assert int(found[1]) < 20


def test_a_swing_lost_in_a_long_rest_is_refused_until_it_is_cut() -> None:
    times = even(0.3, 200, 4000)
    values = swing(times, 0.3) + 0.05 * noise(4000, 2)
    assert "cut the record" in refusal(times, values)
    found = ring_down(times[:80], values[:80])
    assert abs(found.ratio - 0.3) < found.ratio_error < 0.05
