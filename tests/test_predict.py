"""A small part of `make predict`: what a run tells of its error is near the true one."""

from __future__ import annotations

import pytest

from tests.predict.cases import Case, cases
from tests.predict.judge import Told, judged

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
