"""Find out whether bodies of a scene can ever touch, from how far they reach."""

from __future__ import annotations

import itertools

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import Dimension
from somo_cli.manipulator.kinematics import max_distances
from somo_cli.scene.model import Scene
from somo_cli.scene.placement import with_heights

CONTACT_MARGIN = 0.02  # engine units; seen in 3.2.7: contact begins 0.004 units before shapes meet


def can_touch(scene: Scene) -> bool:
    """Return whether two bodies of a scene may touch, whatever their joint angles are.

    The result is False only if no two bodies can touch. All bases are then static and all objects
    fixed, and the sphere that a manipulator cannot leave intersects no other manipulator's sphere,
    no object and not the ground.
    """
    if any(one.has_self_collision for one in scene.manipulators):
        return True
    objects = [one for one in with_heights(scene.objects, scene.ground) if one.collides]
    if len(scene.manipulators) + len(objects) + (scene.ground is not None) < 2:
        return False
    if any(one.base != "static" for one in scene.manipulators):
        return True
    if not all(rigid_object.is_fixed for rigid_object in objects):
        return True
    margin = CONTACT_MARGIN / scene.scale.factor(Dimension(length=1))
    reach_spheres = [
        (one.position, reach(one.compiled.chain) + margin) for one in scene.manipulators
    ]
    others = [(rigid_object.position, reach(rigid_object.chain)) for rigid_object in objects]
    if scene.ground is not None and any(
        centre[2] - radius < scene.ground.height for centre, radius in reach_spheres
    ):
        return True
    pairs = [*itertools.combinations(reach_spheres, 2), *itertools.product(reach_spheres, others)]
    return any(
        geometry.norm(geometry.subtract(one, other)) < radius + other_radius
        for (one, radius), (other, other_radius) in pairs
    )


def reach(chain: Chain) -> float:
    """Return the largest distance [m] of a chain's shapes from the base frame's origin."""
    return max(
        (
            distance + geometry.norm(shape.position) + shape.solid.circumradius
            for distance, link in zip(max_distances(chain), chain.links, strict=True)
            for shape in link.shapes
        ),
        default=0.0,
    )
