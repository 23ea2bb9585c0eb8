"""Objects that stand on others: their heights, from the shapes of both."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.extents import highest, lowest
from somo_cli.simulation.surface import GROUND, Ground
from somo_cli.simulation.things import Thing


def placed(things: Sequence[Thing], ground: Ground | None) -> tuple[Thing, ...]:
    """Return the objects with the height of every one that has a place [m], in their order.

    The order does not matter to what stands on what, which must be known and not go round in a
    circle.
    """
    by_name = {one.name: one for one in things}
    done: dict[str, Thing] = {}

    def settle(one: Thing) -> Thing:
        if one.name not in done:
            done[one.name] = one if one.place is None else _raised(one, top_of(one.place.on))
        return done[one.name]

    def top_of(name: str) -> float:
        if name == GROUND and name not in by_name:
            assert ground is not None, "it was judged"
            return ground.height
        return max(_heights(settle(by_name[name]), highest))

    return tuple(settle(one) for one in things)


def _raised(one: Thing, top: float) -> Thing:
    assert one.place is not None
    x, y, _ = one.position
    level = dataclasses.replace(one, position=(x, y, 0.0))
    return dataclasses.replace(
        one, position=(x, y, top + one.place.gap - min(_heights(level, lowest)))
    )


def _heights(one: Thing, end: Callable[[Shape, Pose], float]) -> list[float]:
    pose = Pose(one.position, geometry.rotation_from_rpy(one.rpy))
    return [end(shape, pose) for shape in one.chain.links[0].shapes]
