"""Which links of one manipulator collide with each other in the engine."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from somo_cli.manipulator.chain import Chain, Shape
from somo_cli.manipulator.solids import Box, Cylinder, Sphere
from somo_cli.simulation.engine.bullet.client import BulletClient


def disable_near_collisions(
    engine: BulletClient, body: int, links: Sequence[int], chain: Chain
) -> None:
    """Let links collide only if they are farther apart than the body is wide, all joints at zero.

    Nearer ones are neighbours, or overlap where hinges are rounded; they meet at the inner side of
    a bend tighter than half the width, where a soft body would be squeezed to nothing, and the
    springs stand for that. The joints of the body are at zero.
    """
    width = _body_width(chain)
    parents = {(joint.parent, child) for child, joint in enumerate(chain.joints, start=1)}
    for (a, link), (b, other) in itertools.combinations(enumerate(links), 2):
        near = (a, b) in parents or engine.getClosestPoints(
            body, body, width, linkIndexA=link, linkIndexB=other
        )
        if near:
            engine.setCollisionFilterPair(body, body, link, other, 0)


def _body_width(chain: Chain) -> float:
    """Return the larger edge of the widest cross-section of what moves; engine units."""
    moving = chain.links[1:]
    return max((_cross_width(shape) for link in moving for shape in link.shapes), default=0.0)


def _cross_width(shape: Shape) -> float:
    solid = shape.solid
    if isinstance(solid, Box):
        return max(solid.size[0], solid.size[1])
    assert isinstance(solid, (Cylinder, Sphere)), "links have no other shapes"
    return 2 * solid.radius
