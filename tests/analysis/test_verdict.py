"""The line that says whether a run is converged, and what to do if not."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from somo_cli.analysis.error_estimate import ColumnError
from somo_cli.analysis.observed_order import ObservedOrder
from somo_cli.analysis.outcomes import outcomes
from somo_cli.analysis.verdict import is_converged, verdict, worst

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


LIFTED, LOST = 0.045, 0.01  # m: a cube that one run lifts and another loses
STEPS = (4e-3, 2e-3, 1e-3)  # s


def parted(*ends: float, steps: tuple[float, ...] = STEPS) -> str:
    """Return the sentence on runs whose cube ends at these heights [m]."""
    table = np.array([[0.0, end] for end in ends])
    found = outcomes([STILL, HEIGHT], steps, table)
    return "" if found is None else found.sentence


def test_two_outcomes_are_both_told() -> None:
    error = dataclasses.replace(HEIGHT, judged=0.04, order=IRREGULAR)
    sentence = (
        "two outcomes: cube.pose.z_m ends at 45 mm at 0.004 and 0.002 s and at 10 mm at 0.001 s"
    )
    assert parted(LIFTED, LIFTED, LOST) == sentence
    assert verdict(2e-3, [error], sentence) == (
        f"NOT converged: cube.pose.z_m differs by 40 mm (80 % of its range); {sentence}; "
        "look with --tolerance whether smaller steps agree"
    )


def test_runs_that_agree_name_the_outcome_that_a_coarser_one_had() -> None:
    sentence = parted(LOST, LIFTED, LIFTED + 1e-6)
    assert sentence.startswith("two outcomes: cube.pose.z_m ends at 10 mm at 0.004 s and at 45 mm")
    assert verdict(2e-3, [HEIGHT], sentence) == f"converged to 0.2 %, but {sentence}"


def test_a_step_alone_between_others_is_an_outcome() -> None:
    assert parted(LIFTED, LOST, LIFTED) == (
        "two outcomes: cube.pose.z_m ends at 10 mm at 0.002 s and at 45 mm at 0.004 and 0.001 s"
    )


def test_chaos_is_told_with_every_end() -> None:
    assert parted(0.0, 0.04, 0.02) == (
        "each step ends elsewhere: cube.pose.z_m ends at 0 mm at 0.004 s, at 40 mm at 0.002 s and "
        "at 20 mm at 0.001 s"
    )


@pytest.mark.parametrize("order", [1, 2])
def test_an_error_that_falls_with_the_step_is_no_outcome(order: int) -> None:
    """However large it is at the coarsest step."""
    assert not parted(*(0.1 * step**order / 1e-3**order for step in STEPS))
    fine = (4e-3, 2e-3, 1e-3, 1e-4)
    assert not parted(*(0.1 * (step / 4e-3) ** order for step in fine), steps=fine)


def test_two_runs_do_not_show_an_outcome() -> None:
    assert not parted(LIFTED, LOST, steps=(2e-3, 1e-3))


def test_what_jumps_by_nature_is_no_outcome() -> None:
    """The speed after an impact that comes a step later is another."""
    speed = dataclasses.replace(HEIGHT, measure="mean")
    assert outcomes([speed], STEPS, np.array([[0.0], [1.0], [0.0]])) is None


@pytest.mark.parametrize(
    ("ends", "is_single"),
    [
        ((LOST, LIFTED, LIFTED), True),
        ((LOST, LIFTED, LIFTED, LIFTED), False),
        ((LIFTED, LIFTED, LOST), False),
        ((LIFTED, LOST, LIFTED), False),
    ],
)
def test_an_outcome_of_a_single_halving_is_known(ends: tuple[float, ...], is_single: bool) -> None:
    steps = tuple(8e-3 / 2**place for place in range(len(ends)))
    found = outcomes([HEIGHT], steps, np.array(ends)[:, np.newaxis])
    assert found is not None
    assert found.parts_last_of_three(steps) is is_single
