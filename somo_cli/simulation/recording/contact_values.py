"""Forces between bodies, objects and the ground, as columns have them: in SI."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.contacts import Touch
from somo_cli.simulation.plan.units import Units


def total_force(touches: Sequence[Touch], number: int, units: Units) -> Sequence[float]:
    """Return the force of all that touches a body or an object, and the sum of normal forces."""
    force = contacts.total(contacts.on(touches, number))
    return [value / units.force for value in force]


def pair_forces(
    touches: Sequence[Touch], number: int, others: Sequence[int], units: Units
) -> Sequence[float]:
    """Return what each of the others does to a body or an object."""
    return [
        value / units.force
        for other in others
        for value in contacts.load(contacts.between(touches, number, other))
    ]


def link_forces(touches: Sequence[Touch], number: int, count: int, units: Units) -> Sequence[float]:
    """Return what touches each of the `count` links of a body."""
    return [
        value / units.force
        for link in range(count)
        for value in contacts.load(contacts.on_link(touches, (number, link)))
    ]
