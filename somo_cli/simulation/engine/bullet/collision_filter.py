"""Which parts of a world in PyBullet can touch, and which are in each other."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.last_contacts import LastContacts
from somo_cli.simulation.plan.model import Plan

MAX_ITERATIONS = 200  # of the solver, at most: few contacts need half of them
CROWD_ITERATIONS = (
    50  # where there are many: what they leave undone is less than what steps get wrong
)
CROWD = 16  # points of contact; what one costs grows with their number
RESIDUAL_SPEED = 1e-11  # m/s: how far the solver may leave a joint or contact from what it is to do


def iteration_limit(points: int) -> int:
    """Return how many iterations the solver may take with so many points of contact."""
    return MAX_ITERATIONS if points <= CROWD else CROWD_ITERATIONS


def squared_residual_speed(plan: Plan) -> float:
    """Return the square of the speed [engine units/s] that the solver may leave undone."""
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
    """Keep bases that a constraint holds from colliding with each other and with what is held.

    Two of which neither yields would fight without end; for fixed ones the engine does so itself.
    The numbers are the engine's, of bodies.
    """
    for base in constrained:
        for other in held:
            if other != base:
                engine.setCollisionFilterPair(base, other, -1, -1, 0)


def depths(engine: BulletClient, order: Sequence[int]) -> dict[tuple[int, int], float]:
    """Return how deep two bodies are in each other, for all that are, where they are now.

    By their places in `order`, which lists the engine's numbers; the smaller place comes first.
    What cannot collide is in nothing. The world should not be run any more: the engine remembers
    what it was asked.
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
