"""Forces between bodies, objects and the ground, as columns have them: in SI."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.contacts import ContactPoint
from somo_cli.simulation.plan.units import UnitFactors


def total_force(points: Sequence[ContactPoint], number: int, units: UnitFactors) -> Sequence[float]:
    """Return the force of all that touches a body or an object, and the sum of normal forces."""
    force = contacts.total_force(contacts.contacts_on(points, number))
    return [value / units.force for value in force]


def pair_forces(
    points: Sequence[ContactPoint], number: int, others: Sequence[int], units: UnitFactors
) -> Sequence[float]:
    """Return what each of the others does to a body or an object."""
    return [
        value / units.force
        for other in others
        for value in contacts.contact_force(contacts.contacts_between(points, number, other))
    ]


def link_forces(
    points: Sequence[ContactPoint], number: int, count: int, units: UnitFactors
) -> Sequence[float]:
    """Return what touches each of the `count` links of a body."""
    return [
        value / units.force
        for link in range(count)
        for value in contacts.contact_force(contacts.contacts_on_link(points, (number, link)))
    ]
