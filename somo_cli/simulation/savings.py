"""Count what a plan saves the engine and the loop: shapes, links, pairs, rows, columns."""

from __future__ import annotations

import dataclasses
import math

from somo_cli.scene import columns
from somo_cli.scene.model import ALL_OBJECT_QUANTITIES, ALL_QUANTITIES
from somo_cli.simulation.plan.model import Plan


def solids(plan: Plan) -> int:
    """Return the number of solids that the links of all manipulators are made of."""
    return sum(len(link.shapes) for body in plan.bodies for link in body.chain.links)


def merged_links(plan: Plan) -> int:
    """Return how many more links there would be, on fixed joints, if each solid were a link."""
    return sum(max(0, len(link.shapes) - 1) for body in plan.bodies for link in body.chain.links)


def untested_link_pairs(plan: Plan) -> int:
    """Return the number of link pairs within manipulators that are not tested for contact.

    Without `self_collision` all of them, else those of neighbours.
    """
    return sum(
        len(body.chain.joints) if body.has_self_collision else math.comb(len(body.chain.links), 2)
        for body in plan.bodies
    )


def fixed_pairs(plan: Plan) -> int:
    """Return the number of pairs of parts that cannot move: held bases, held objects, ground."""
    held = sum(body.base != "free" for body in plan.bodies)
    held += sum(planned.rigid_object.has_prescribed_pose for planned in plan.objects)
    return math.comb(held + (plan.ground is not None), 2)


def available_columns(plan: Plan) -> int:
    """Return the number of columns of a scene that records everything, without the time."""
    readings = ALL_OBJECT_QUANTITIES if plan.objects else ()
    whole = dataclasses.replace(plan, columns=ALL_QUANTITIES, object_quantities=readings, only=())
    return len(columns.header(whole.recorded)) - 1
