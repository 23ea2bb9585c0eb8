"""The starfish on the ground: what its arms bear is its weight, below its centre of mass."""

from __future__ import annotations

import numpy as np
import pytest

from tests.studies import starfish
from tests.studies.running import recorded
from tests.studies.starfish import PAUSES

pytest.importorskip("pybullet")
pytestmark = pytest.mark.slow


def leaning(time_step: float, *sets: str) -> starfish.Stand:
    """Return how it stands until it has leaned towards arm_0."""
    run = recorded(starfish.setting(PAUSES[1], time_step, *sets))
    return starfish.stand(run, starfish.starfish())


def test_the_arms_bear_the_weight_below_the_centre_of_mass() -> None:
    chain, one = starfish.starfish(), leaning(2e-3)
    for time in PAUSES[:2]:
        row = one.at(time)
        assert one.loads[:, row].sum() == pytest.approx(starfish.weight(chain), rel=1e-4)
        assert one.on_disc[row] == 0
        assert one.pressure_centre[:, row] == pytest.approx(one.mass_centre[:2, row], abs=5e-5)
    # it stays in the plane of arm_0, as arms 1 and 4 do the same, and 2 and 3
    assert np.abs(one.mass_centre[1]).max() < 2e-5


def shift(time_step: float, *sets: str) -> float:
    """Return how far the centre of mass has moved at the second pause [m]."""
    one = leaning(time_step, *sets)
    return float(one.mass_centre[0, one.at(PAUSES[1])])


def test_the_shift_converges_with_the_step_and_does_not_depend_on_the_scale() -> None:
    shifts = [shift(step) for step in (2e-3, 1e-3, 5e-4)]
    # with the engine's own friction: 4.1 to 6.4 mm to the other side, by the heading of the arms
    assert shifts[0] == pytest.approx(-2.09e-3, rel=0.02)
    # -2.092, -2.205 and -2.237 mm: each halving leaves a third of the change
    assert shifts[1:] == pytest.approx([-2.205e-3, -2.237e-3], rel=0.02)
    assert abs(shifts[2] - shifts[1]) < 0.5 * abs(shifts[1] - shifts[0])
    assert shift(2e-3, "world_scale=40") == pytest.approx(shifts[0], rel=1e-6)
