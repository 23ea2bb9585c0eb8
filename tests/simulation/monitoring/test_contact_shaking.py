"""Forces that keep varying while nothing drives them are found, and no others."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from somo_cli.simulation.monitoring.contact_shaking import ContactShakingMonitor
from somo_cli.simulation.plan.model import Plan
from tests.builders.rigid_objects import plan_with_plate

INTERVAL = 8  # steps between two checks
STEP = 1e-3


def monitored(
    force: Callable[[float], float], seconds: float = 2.0, is_driven: bool = False
) -> ContactShakingMonitor:
    """Return a monitor that has sampled a force over time; a force of zero is no contact."""
    monitor = ContactShakingMonitor(plan())
    for step in range(round(seconds / STEP)):
        value = force(step * STEP)
        forces = {(0, 1): value} if value > 0 else {}
        if step % INTERVAL == 0:
            monitor.update(step * STEP, forces, is_driven)
        if monitor.wants_every_step:
            monitor.sample(forces)
    return monitor


def plan() -> Plan:
    return plan_with_plate(STEP)


def swing(size: float, rate: float = 37.0, decay: float = 0.0) -> Callable[[float], float]:
    return lambda t: 3 + size * math.exp(-decay * t) * math.sin(2 * math.pi * rate * t)


def test_a_force_that_swings_for_ever_is_found_with_its_frequency() -> None:
    (found,) = monitored(swing(1.2)).findings.values()
    assert found.code == "contact-shakes"
    assert found.names == ("body", "plate")
    values = dict(found.values)
    newton = values["mean_n"] / 3
    assert values["deviation_n"] == pytest.approx(1.2 / math.sqrt(2) * newton, rel=0.1)
    assert values["frequency_hz"] == pytest.approx(37, rel=0.03)
    assert found.message.endswith("and nothing drives it (about 37 times a second)")
    assert 0.4 < found.time < 0.7


@pytest.mark.parametrize("rate", [13.0, 37.0, 99.0])
def test_a_swing_that_grows_is_found(rate: float) -> None:
    assert monitored(swing(0.2, rate, decay=-1)).findings


@pytest.mark.parametrize(
    ("force", "is_driven"),
    [
        (lambda t: 3.0, False),
        (swing(0.02), False),  # below half a per cent of the mean
        (swing(2.0, 5.0, decay=0.02 * 2 * math.pi * 5), False),  # a slow mode, lightly damped
        (swing(2.0, 37.0, decay=0.02 * 2 * math.pi * 37), False),
        (lambda t: 3 + 2 * t, False),  # what a slow motion does
        (lambda t: 3 - 1.4 * t, False),
        (swing(1.2), True),
    ],
)
def test_nothing_else_is_found(force: Callable[[float], float], is_driven: bool) -> None:
    assert not monitored(force, is_driven=is_driven).findings


def test_contact_lost_while_it_shook_is_found_and_other_is_not() -> None:
    shaking = swing(1.2)
    codes = [one.code for one in monitored(lambda t: shaking(t) * (t < 1.2)).findings.values()]
    assert codes == ["contact-shakes", "contact-lost"]
    assert not monitored(lambda t: 3.0 * (t < 1.2)).findings  # it slid off, or was let go


def test_the_time_of_loss_is_that_of_the_last_contact() -> None:
    shaking = swing(1.2)
    found = monitored(lambda t: shaking(t) * (t < 1.2)).findings
    (lost,) = (one for one in found.values() if one.code == "contact-lost")
    assert lost.time == pytest.approx(1.2, abs=0.02)
