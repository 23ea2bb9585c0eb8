"""What a plan spares the engine and the loop, counted: shapes, links, pairs, rows, columns."""

from __future__ import annotations

import dataclasses
import math

from somo_cli.simulation import columns
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.scene import ALL_COLUMNS, ALL_READINGS


def solids(plan: Plan) -> int:
    """Return the number of solids that the links of all manipulators are made of."""
    return sum(len(link.shapes) for body in plan.bodies for link in body.chain.links)


def merged_links(plan: Plan) -> int:
    """Return how many links fixed joints would join more, were every solid a link of its own."""
    return sum(max(0, len(link.shapes) - 1) for body in plan.bodies for link in body.chain.links)


def own_pairs(plan: Plan) -> int:
    """Return the pairs of links within manipulators that are surely not tested for contact.

    Without self_collision all of them, else those of neighbours.
    """
    return sum(
        len(body.chain.joints) if body.collides_with_itself else math.comb(len(body.chain.links), 2)
        for body in plan.bodies
    )


def held_pairs(plan: Plan) -> int:
    """Return the pairs of parts neither of which could yield: held bases and objects, ground."""
    held = sum(body.base != "free" for body in plan.bodies)
    held += sum(planned.thing.is_held for planned in plan.things)
    return math.comb(held + (plan.ground is not None), 2)


def columns_at_hand(plan: Plan) -> int:
    """Return how many columns a scene has if it records all there are, the time not counted."""
    readings = ALL_READINGS if plan.things else ()
    whole = dataclasses.replace(plan, columns=ALL_COLUMNS, of_things=readings, only=())
    return len(columns.header(whole)) - 1
