"""The columns of forces between bodies, objects and the ground: names, and values in SI."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.simulation import touching
from somo_cli.simulation.plan import Plan, names_by_number, others_of
from somo_cli.simulation.touching import Touch
from somo_cli.simulation.units import Units

TOTAL = ("fx_n", "fy_n", "fz_n", "normal_n")
LOAD = (*TOTAL, "friction_n", "friction_x_n", "friction_y_n", "friction_z_n")


def pair_names(plan: Plan, number: int) -> list[str]:
    """Return the columns of the force of each other on a body or an object, by its number."""
    names = names_by_number(plan)
    return [f"contact.{names[other]}.{one}" for other in others_of(plan, number) for one in LOAD]


def total(touches: Sequence[Touch], number: int, units: Units) -> Sequence[float]:
    """Return the force of all that touches a body or an object, and the sum of normal forces."""
    force = touching.total(touching.on(touches, number))
    return [value / units.force for value in force]


def pairs(
    touches: Sequence[Touch], number: int, others: Sequence[int], units: Units
) -> Sequence[float]:
    """Return what each of the others does to a body or an object."""
    return [
        value / units.force
        for other in others
        for value in touching.load(touching.between(touches, number, other))
    ]


def links(touches: Sequence[Touch], number: int, count: int, units: Units) -> Sequence[float]:
    """Return what touches each of the `count` links of a body."""
    return [
        value / units.force
        for link in range(count)
        for value in touching.load(touching.on_link(touches, (number, link)))
    ]
