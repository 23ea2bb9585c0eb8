"""Energy that nothing put in is found, whatever form it has."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.simulation.monitoring.energy_growth import EnergyGrowthMonitor, Ledger
from somo_cli.simulation.monitoring.findings import Finding
from tests.builders.rigid_objects import plan_with_plate


def found(ledgers: Sequence[tuple[float, float, float]], floor: float = 0.0) -> Finding | None:
    """Return what is found of ledgers, 0.02 s apart: mobile energy, potential and work."""
    rows = iter(Ledger(*one) for one in ledgers)
    monitor = EnergyGrowthMonitor(plan_with_plate(), floor, lambda: next(rows))
    for number in range(len(ledgers)):
        monitor.update(0.02 * number)
    return monitor.finding


def test_a_fall_a_swing_and_work_are_no_gain() -> None:
    assert found([(0, 1, 0), (0.5, 0.5, 0), (0.9, 0, 0), (0.3, 0.5, 0)]) is None
    assert found([(0, 0, 0), (1, 0, 1.2), (2, 0, 2.5)]) is None
    assert found([(1, 0, 0), (1.02, 0, 0), (0.99, 0, 0), (1.02, 0, 0)]) is None


def test_what_contact_adds_is_found_after_what_it_took() -> None:
    """A body that lost half of its energy and wins a tenth again has less than it had."""
    one = found([(1, 0, 0), (0.5, 0, 0), (0.52, 0, 0), (0.6, 0, 0), (9, 0, 0)])
    assert one is not None
    assert (one.code, one.time) == ("contact-energy", 0.06)
    assert dict(one.values)["energy_gained_j"] / dict(one.values)["energy_scale_j"] == (
        (0.6 - 0.5) / 1
    )


def test_to_be_lifted_out_of_a_slight_overlap_is_no_gain() -> None:
    assert found([(0, 0, 0), (1e-6, 1e-4, 0)], floor=2e-4) is None
    assert found([(0, 0, 0), (1e-6, 3e-4, 0)], floor=2e-4) is not None
