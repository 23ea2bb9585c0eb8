"""A small part of `make predict`: what a run tells of its error is near the true one."""

from __future__ import annotations

import pytest

from tests.predict.cases import Case, cases, striking, to_tolerance, with_contact
from tests.predict.contact_step import Ladder, Rung, climbed
from tests.predict.judge import Told, judged
from tests.predict.tolerance import ASKED, kept

CASES = {case.name: case for case in cases()}
FREE = ("arm_scene", "gait_scene", "scene", "three_axis_finger_scene")


@pytest.mark.moderate
@pytest.mark.parametrize("name", FREE)
def test_free_motion_is_told_within_a_factor(name: str) -> None:
    found = judged(CASES[name])
    assert not found.has_contact
    assert found.ratios
    assert min(found.ratios) > 1 / 1.5
    assert max(found.ratios) < 3


@pytest.mark.slow
def test_contact_is_told_within_a_factor() -> None:
    found = judged(CASES["press_scene"])
    assert found.has_contact
    assert found.ratios
    assert min(found.ratios) > 1 / 3


def test_two_outcomes_and_negligible_errors_are_not_held_against_each_other() -> None:
    found = Told("a", True, "done", told=(1e-7, 2e-3, 0.5), true=(1e-6, 1e-3, 0.6))
    assert found.ratios == (2.0,)


def test_the_cases_are_the_same_each_time() -> None:
    again: list[Case] = cases()
    assert [case.name for case in again] == list(CASES)
    assert [case.scene for case in again] == [case.scene for case in CASES.values()]


@pytest.mark.slow
def test_a_tolerance_is_kept_and_its_cost_is_told() -> None:
    by_name = {case.name: case for case in to_tolerance()}
    assert len(by_name) == 10
    found = kept(by_name["press_scene"])
    assert found.end == "converged"
    assert found.told <= ASKED
    assert found.true < 2 * ASKED
    assert found.cost > 2  # the runs at the scene's own step and at half of it, at least


@pytest.mark.slow
def test_the_recommended_step_of_a_turned_bar_has_no_finding_and_is_not_far_too_fine() -> None:
    (case,) = (one for one in with_contact() if one.name == "turn_scene")
    found = climbed(case)
    assert found.recommended == 1e-3
    assert found.own.holds
    assert 1 <= found.times_too_fine <= 4
    assert found.rungs[0].error > found.own.error > found.rungs[-1].error


def test_a_step_holds_if_it_and_all_smaller_ones_do() -> None:
    def ladder(*errors: float, findings: tuple[str, ...] = ()) -> Ladder:
        steps = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4)
        rungs = [Rung(step, (), error) for step, error in zip(steps, errors, strict=True)]
        rungs[2] = Rung(2e-3, findings, errors[2])
        return Ladder("a", 1e-3, tuple(rungs))

    assert ladder(0.1, 0.009, 0.005, 0.002, 0.001).times_too_fine == 4
    assert ladder(0.1, 0.009, 0.005, 0.002, 0.001, findings=("contact-lost",)).times_too_fine == 1
    assert ladder(0.009, 0.1, 0.005, 0.002, 0.001).times_too_fine == 2
    assert ladder(0.1, 0.1, 0.1, 0.1, 0.001).times_too_fine == 0.5
    assert not ladder(0.1, 0.1, 0.1, 0.1, 0.1).is_settled


@pytest.mark.moderate
def test_joints_that_strike_are_told_within_a_factor() -> None:
    found = judged(striking()[0])
    assert not found.has_contact
    assert found.ratios
    assert 1 / 1.5 < min(found.ratios) < max(found.ratios) < 2
