"""Random extreme contact scenes: none that is unphysical ends without a finding."""

from __future__ import annotations

import pytest

from tests.trust.judge import Outcome, outcome
from tests.trust.scenes import random_scenes
from tests.trust.shipped import NAMES, shipped_findings

COUNT = 100
# each is quick, and of each family there is one that goes wrong and one that does not
QUICK = (1, 4, 7, 16, 22, 23, 24, 34, 36, 43, 66, 72, 79, 88, 96)


@pytest.mark.slow
@pytest.mark.parametrize("number", QUICK)
def test_what_is_unphysical_is_found(number: int) -> None:
    assert not outcome(random_scenes(COUNT)[number]).is_silent


@pytest.mark.slow
def test_a_finger_that_is_crushed_in_one_step_is_found_and_one_that_is_caught_is_not() -> None:
    scenes = random_scenes(COUNT)
    crushed = outcome(scenes[22])
    assert crushed.end == "diverged" or "deep-penetration" in crushed.codes
    assert outcome(scenes[4]) == Outcome(scenes[4].name, 5e-4, "done")


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_shipped_scene_is_no_false_alarm(name: str) -> None:
    assert shipped_findings(1.0, [name]) == []


def test_the_same_seed_gives_the_same_scenes() -> None:
    assert random_scenes(12) == random_scenes(24)[:12]
    assert random_scenes(12, seed=2) != random_scenes(12)
