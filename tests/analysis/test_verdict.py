"""The line that says whether a run is converged, and what to do if not."""

from __future__ import annotations

import dataclasses
import math

import pytest

from somo_cli.analysis.error_estimate import ColumnError
from somo_cli.analysis.observed_order import ObservedOrder
from somo_cli.analysis.verdict import has_two_outcomes, is_converged, verdict, worst

SECOND = ObservedOrder(2.0, 2)
IRREGULAR = ObservedOrder(math.nan, 2, is_irregular=True)
HEIGHT = ColumnError(
    name="cube.pose.z_m",
    unit="m",
    measure="largest",
    final=0.0,
    maximum=1e-4,
    rms=0.0,
    judged=1e-4,
    scale=0.05,
    order=SECOND,
    ends=(0.03, 0.03),
)
STILL = dataclasses.replace(HEIGHT, name="base.pose.x_m", judged=0.0, scale=0.0)


def test_a_small_error_is_converged() -> None:
    assert verdict(1e-3, [STILL, HEIGHT]) == "converged to 0.2 %"
    assert worst([STILL, HEIGHT]) == [HEIGHT, STILL]
    assert verdict(1e-3, [STILL]) == "converged to 0 %"


def test_a_run_of_which_only_the_start_is_recorded_is_not_judged() -> None:
    assert verdict(1e-3, []).startswith("NOT judged: only the start is recorded")
    assert not is_converged([])


@pytest.mark.parametrize(
    ("order", "step"),
    [(SECOND, "0.0005"), (ObservedOrder(1.0, 2), "0.0002"), (IRREGULAR, "0.0002")],
)
def test_a_large_one_says_which_step_to_try_by_its_order(order: ObservedOrder, step: str) -> None:
    error = dataclasses.replace(HEIGHT, judged=1.5e-3, order=order)
    assert verdict(1e-3, [error]) == (
        f"NOT converged: cube.pose.z_m differs by 1.5 mm (3 % of its range); try --time-step {step}"
    )


def test_a_step_is_not_cut_by_more_than_sixty_four() -> None:
    error = dataclasses.replace(HEIGHT, judged=50.0, order=IRREGULAR)
    assert verdict(1e-3, [error]).endswith("try --time-step 1e-05")


def test_a_force_and_a_rate_say_how_they_are_judged() -> None:
    force = dataclasses.replace(
        HEIGHT, name="cube.contact.fz_n", unit="N", measure="impulse", judged=0.03, scale=1.0
    )
    assert "differs by 0.03 N by its impulse (3 % of its range)" in verdict(1e-3, [force])
    rate = dataclasses.replace(force, unit="rad/s", measure="mean")
    assert "differs by 0.03 rad/s on average (3 % of its range)" in verdict(1e-3, [rate])


def test_two_outcomes_are_both_told() -> None:
    """A cube that one run lifts and the other loses."""
    lost = dataclasses.replace(HEIGHT, judged=0.04, order=IRREGULAR, ends=(0.045, 0.01))
    assert verdict(1e-3, [HEIGHT, lost]) == (
        "NOT converged: cube.pose.z_m differs by 40 mm (80 % of its range); two outcomes: "
        "cube.pose.z_m ends at 45 mm and 10 mm at 0.001 and 0.0005 s; look with --tolerance "
        "whether smaller steps agree"
    )
    assert not has_two_outcomes(dataclasses.replace(lost, order=SECOND))
    assert not has_two_outcomes(dataclasses.replace(lost, ends=(0.045, 0.044)))
