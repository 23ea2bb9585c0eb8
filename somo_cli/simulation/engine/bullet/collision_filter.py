"""Which parts of a world in PyBullet can touch, and which overlap."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.last_contacts import LastContacts
from somo_cli.simulation.plan.model import Plan

MAX_ITERATIONS = 200  # of the solver; few contacts need half of them
CROWD_ITERATIONS = 50  # with many contacts: what they leave is below the error of the step
CROWD = 16  # contact points; the cost of an iteration grows with their number
RESIDUAL_SPEED = 1e-11  # m/s: residual velocity of joints and contacts that the solver tolerates


def iteration_limit(points: int) -> int:
    """Return the largest number of solver iterations for a number of contact points."""
    return MAX_ITERATIONS if points <= CROWD else CROWD_ITERATIONS


def squared_residual_speed(plan: Plan) -> float:
    """Return the square of the residual speed [engine units/s] at which the solver may stop."""
    speed: float = RESIDUAL_SPEED * plan.scale.length
    return speed**2


def disable_collisions(engine: BulletClient, body: int, links: Iterable[int]) -> None:
    """Keep links of a body from being paired with anything.

    Seen in 3.2.7: links without shapes are paired with those near them all the same, in every step.
    """
    for link in links:
        engine.setCollisionFilterGroupMask(body, link, 0, 0)


def disable_fixed_collisions(
    engine: BulletClient, constrained: Iterable[int], held: Sequence[int]
) -> None:
    """Keep constrained bases from colliding with each other and with fixed bodies.

    Neither of two such bodies can move, so they would push each other without end. The engine
    itself excludes pairs of fixed bodies only. Bodies are given by the engine's numbers.
    """
    for base in constrained:
        for other in held:
            if other != base:
                engine.setCollisionFilterPair(base, other, -1, -1, 0)


def depths(engine: BulletClient, order: Sequence[int]) -> dict[tuple[int, int], float]:
    """Return the depths of all overlaps of two bodies at their present poses.

    Bodies are named by their places in `order`, which lists the engine's numbers; the smaller place
    comes first. Bodies that cannot collide do not overlap. Do not step the world afterwards: the
    engine remembers the query.
    """
    engine.performCollisionDetection()
    places = {number: place for place, number in enumerate(order)}
    found: dict[tuple[int, int], float] = {}
    for point in LastContacts(engine).points():
        first, second = sorted((places[point.first_body], places[point.second_body]))
        depth = -point.gap
        if first != second and depth > found.get((first, second), 0.0):
            found[first, second] = depth
    return found
