"""Forces between bodies, objects and the ground, as columns have them: in SI."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.contacts import ContactPoint
from somo_cli.simulation.plan.units import UnitFactors


class StatesInContact(Protocol):
    """A body or an object in several rows."""

    @property
    def number(self) -> int:
        """Its number, objects counted after all bodies."""

    @property
    def others(self) -> Sequence[int]:
        """The numbers of the partners that columns name."""

    @property
    def contacts(self) -> Sequence[Sequence[ContactPoint]]:
        """All contact points of the step before each row."""


def total_forces(states: StatesInContact, units: UnitFactors) -> Array:
    """Return `total_force` of each row, shape (4, rows)."""
    number = states.number
    return np.array([total_force(row, number, units) for row in states.contacts]).T


def forces_of_partners(states: StatesInContact, units: UnitFactors) -> Array:
    """Return `pair_forces` of each row, shape (8 for each partner, rows)."""
    number, others = states.number, states.others
    return np.array([pair_forces(row, number, others, units) for row in states.contacts]).T


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
