"""Which links and objects of a scene can touch each other, and the friction between them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain, Shape
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.manipulator.solids import Box, Cylinder, Sphere
from somo_cli.scene.contact_surface import ContactSurface


@dataclass(frozen=True, slots=True)
class Touchable:
    """A link, an object or the ground: its geoms, its surface, and whether it can be pushed.

    `near` has the ids of links of its own manipulator that it does not collide with.
    """

    owner: str
    link: int
    geoms: tuple[str, ...]
    surface: ContactSurface
    is_held: bool
    near: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class PairFriction:
    """Friction coefficients of a pair: sliding [-], spinning and rolling as moment arms [m]."""

    sliding: float
    spinning: float
    rolling: float

    @staticmethod
    def of(a: ContactSurface, b: ContactSurface) -> PairFriction:
        """Return the friction between two surfaces as a run has it: products, not the larger."""
        return PairFriction(
            a.friction * b.friction,
            a.spinning_friction * b.friction + b.spinning_friction * a.friction,
            a.rolling_friction * b.friction + b.rolling_friction * a.friction,
        )


def touching_pairs(parts: Sequence[Touchable]) -> Iterator[tuple[Touchable, Touchable]]:
    """Yield the pairs that a run lets collide: not two that are held, nor links that are near."""
    for a, b in itertools.combinations(parts, 2):
        if a.is_held and b.is_held:
            continue
        if a.owner == b.owner and b.link in a.near:
            continue
        yield a, b


def near_links(chain: Chain) -> list[frozenset[int]]:
    """Return for each link those that it does not collide with: neighbours, and what is near.

    Near is nearer than the body is wide, all joints at zero, as in a run: there the springs stand
    for what a bend squeezes. The distance is that along the best of four directions, which is exact
    for boxes that stand in line and a lower bound for others.
    """
    poses = link_poses(chain, (0.0,) * len(chain.joints), Pose())
    width = max((_width(shape) for link in chain.links[1:] for shape in link.shapes), default=0.0)
    found: list[set[int]] = [{number} for number in range(len(chain.links))]
    parents = {(joint.parent, child) for child, joint in enumerate(chain.joints, start=1)}
    for a, b in itertools.combinations(range(len(chain.links)), 2):
        shapes = itertools.product(chain.links[a].shapes, chain.links[b].shapes)
        is_near = any(_gap(one, poses[a], other, poses[b]) <= width for one, other in shapes)
        if is_near or (a, b) in parents:
            found[a].add(b)
            found[b].add(a)
    return [frozenset(one) for one in found]


def _width(shape: Shape) -> float:
    if isinstance(shape.solid, Box):
        return max(shape.solid.size[:2])
    assert isinstance(shape.solid, Cylinder | Sphere), "links have no other shapes"
    return 2 * shape.solid.radius


def _gap(one: Shape, at: Pose, other: Shape, other_at: Pose) -> float:
    """Return a lower bound of the distance between two shapes; negative if they may overlap."""
    pose = at.compose(Pose.of(one.position, one.rpy))
    other_pose = other_at.compose(Pose.of(other.position, other.rpy))
    apart = geometry.subtract(other_pose.position, pose.position)
    length = geometry.norm(apart)
    if length == 0:
        return -1.0
    directions = [geometry.unit(apart), *geometry.transposed(pose.rotation)]
    return max(
        abs(geometry.dot(apart, along))
        - _reach(one, pose, along)
        - _reach(other, other_pose, along)
        for along in directions
    )


def _reach(shape: Shape, pose: Pose, along: geometry.Vector) -> float:
    return shape.solid.reach(geometry.rotate(geometry.transposed(pose.rotation), along))
