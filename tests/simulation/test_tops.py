"""A spinning top precesses as theory says, the finer its tip the closer."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.free_bodies.tops import measured_precession, steady_precession

SPIN = 300.0  # rad/s, 0.3 rad in a step of 1 ms


@pytest.mark.moderate
@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_a_top_on_a_fine_tip_is_the_heavy_top(tmp_path: Path, step: float) -> None:
    """A round tip rolls, which slows the precession in proportion to its radius and lifts the top.

    Carried on to a tip without a radius, the rate is that of the heavy top.
    """
    off = [
        measured_precession(tmp_path, SPIN, tip, step)[0] / steady_precession(SPIN, tip) - 1
        for tip in (5e-4, 2e-4)
    ]
    assert -0.05 < off[0] < off[1] < 0
    assert off[1] - (off[0] - off[1]) * 2 / 3 == pytest.approx(0, abs=2e-3)


@pytest.mark.moderate
def test_the_tip_lifts_the_top_and_no_step_matters(tmp_path: Path) -> None:
    rates, rises = zip(
        *(measured_precession(tmp_path, SPIN, 1e-3, step) for step in (1e-3, 2.5e-4)), strict=True
    )
    assert rates[0] == pytest.approx(rates[1], rel=2e-3)
    assert all(0 < rise < 0.05 for rise in rises)
