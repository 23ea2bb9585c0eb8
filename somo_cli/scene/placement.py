"""Compute the heights of objects that stand on the ground or on other objects."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.contact_surface import GROUND_NAME, Ground
from somo_cli.scene.extents import max_height, min_height
from somo_cli.scene.rigid_object import RigidObject


def with_heights(objects: Sequence[RigidObject], ground: Ground | None) -> tuple[RigidObject, ...]:
    """Return the objects in the same order, with the position of each `place` computed [m].

    An object may stand on one that comes later in the list. Every support must exist, and no object
    may stand on itself, directly or through others.
    """
    by_name = {one.name: one for one in objects}
    by_name_placed: dict[str, RigidObject] = {}

    def placed(one: RigidObject) -> RigidObject:
        if one.name not in by_name_placed:
            by_name_placed[one.name] = (
                one if one.placement is None else _resting_on(one, top_of(one.placement.on))
            )
        return by_name_placed[one.name]

    def top_of(name: str) -> float:
        if name == GROUND_NAME and name not in by_name:
            assert ground is not None, "the checks report a missing ground"
            return ground.height
        return max(_heights(placed(by_name[name]), max_height))

    return tuple(placed(one) for one in objects)


def _resting_on(one: RigidObject, top: float) -> RigidObject:
    assert one.placement is not None
    x, y, _ = one.position
    at_zero_height = dataclasses.replace(one, position=(x, y, 0.0))
    return dataclasses.replace(
        one, position=(x, y, top + one.placement.gap - min(_heights(at_zero_height, min_height)))
    )


def _heights(one: RigidObject, height_of: Callable[[Shape, Pose], float]) -> list[float]:
    return [height_of(shape, one.pose) for shape in one.chain.links[0].shapes]
