"""The force of a pressing finger is that of the equilibrium, at any step and world scale."""

from __future__ import annotations

import numpy as np
import pytest

from tests.studies.blocked_force import Finger, finger, press, residuals

pytest.importorskip("pybullet")


@pytest.fixture(scope="module")
def one() -> Finger:
    return finger()


def test_small_torques_follow_the_line_and_large_ones_press_harder(one: Finger) -> None:
    assert one.equilibrium(1e-5) == pytest.approx(one.line(1e-5), rel=1e-6)
    full = 1e5 * one.torque_per_pressure
    assert one.equilibrium(full) / one.line(full) == pytest.approx(1.031, abs=1e-3)


@pytest.mark.moderate
@pytest.mark.parametrize(("scale", "step"), [(20, 1e-3), (10, 1e-3), (40, 1e-3), (20, 2e-3)])
def test_force_is_that_of_the_equilibrium(one: Finger, scale: int, step: float) -> None:
    run = press(f"world_scale={scale}", time_step=step)
    truth = one.equilibrium(1e5 * one.torque_per_pressure)
    assert run.held() == pytest.approx(truth, rel=1e-5)
    # on the ramps there is the damper's force, too, and kinks of the pressure make the finger swing
    off = residuals(run, one)
    assert np.abs(off).max() < 2.5e-3
    settled = (run.times > 0.5) & (run.times < 1.9)
    assert np.abs(off[settled]).max() < 1e-4


def test_friction_on_the_block_hides_force_while_it_rises_and_falls() -> None:
    rough = press("objects[0].friction=1")
    torque = 0.5 * rough.torques.max()
    assert rough.held() < 0.6
    assert rough.at(torque, falling=True) > 0.4 > 0.3 > rough.at(torque)
