"""The planar arm comes to rest where statics says."""

from __future__ import annotations

import numpy as np
import pytest

from tests.studies import reaching
from tests.studies.reaching import PULL, Reach
from tests.studies.running import recorded

pytest.importorskip("pybullet")

BENT = (1.5, 1.5, -1.0, -1.0)  # N·m
WITHOUT, WITH = Reach(BENT, 0.0), Reach(BENT, PULL)


def test_without_gravity_every_joint_is_at_torque_over_stiffness() -> None:
    chain = reaching.arm()
    assert reaching.at_rest(chain, WITHOUT) == pytest.approx(
        reaching.by_hand(chain, WITHOUT), abs=1e-12
    )
    straightened = reaching.at_rest(chain, WITH)
    assert straightened[1] - reaching.at_rest(chain, WITHOUT)[1] > 0.01


@pytest.mark.slow
@pytest.mark.parametrize("reach", [WITHOUT, WITH])
def test_the_tip_comes_to_rest_where_statics_says(reach: Reach) -> None:
    place = reaching.at_rest(reaching.arm(), reach)
    run = recorded(reach.setting(20.0))
    assert reaching.tip(run)[:, -1] == pytest.approx(place, abs=5e-5)
    # the lowest mode decays by 0.05 s / 2 * (4.4 rad/s)^2 = 0.48 a second
    assert reaching.settled(run, place, 0.005) == pytest.approx(8, abs=2)


@pytest.mark.slow
def test_the_motion_depends_neither_on_the_step_nor_on_the_scale() -> None:
    settings = [
        WITH.setting(1.0, 1e-3),
        WITH.setting(1.0, 5e-4),
        *(WITH.setting(1.0, 1e-3, f"world_scale={scale}") for scale in (10, 40)),
    ]
    first, *others = (reaching.tip(recorded(setting)) for setting in settings)
    for other in others:
        assert np.abs(other - first).max() < 1e-4
