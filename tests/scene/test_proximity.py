"""Whether parts of a scene can be near each other: never no where the engine finds contact."""

from __future__ import annotations

import itertools
import json
import math
import random
import time
from typing import Any

import pytest

from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.proximity import (
    BoundingBox,
    _boxes_intersect,
    _do_any_intersect,
    bounding_box,
    can_overlap_at_start,
)
from somo_cli.scene.rigid_object import read_object
from tests.builders.definitions import Data, X, actuator, manipulator
from tests.builders.scenes import scene_from_text

BODY = manipulator(actuator(4, X))
BALL: Data = {"name": "ball", "shape_type": "sphere", "dimensions": [0.1], "mass": 1}


def crowded(*objects: Data, others: tuple[Data, ...] = (), **of_scene: Any) -> bool:
    one = {"definition": BODY, "position": [9, 9, 9]}
    data = {"manipulators": [one, *others], "objects": list(objects), **of_scene}
    return can_overlap_at_start(scene_from_text(json.dumps(data)))


def test_what_is_far_apart_is_not_crowded() -> None:
    assert not crowded()
    assert not crowded(
        BALL, {**BALL, "name": "other", "position": [1, 0, 0]}, ground={"height": -1}
    )
    assert not crowded(others=({"definition": BODY, "name": "other"},))


def test_what_is_near_is() -> None:
    assert crowded(BALL, {**BALL, "name": "other", "position": [0.19, 0, 0]})
    assert crowded({**BALL, "position": [9, 9, 9.15]})
    assert crowded(BALL, {**BALL, "name": "other", "position": [5, 0, 0], "place": {"on": "ball"}},
                   {**BALL, "name": "third", "position": [5, 0, 0.2]})  # fmt: skip
    assert crowded(others=({"definition": BODY, "name": "other", "position": [9, 9, 9.07]},))


def test_what_is_held_may_stand_in_what_is_held_and_in_the_ground() -> None:
    fixed = {**BALL, "fixed": True}
    assert not crowded(fixed, {**fixed, "name": "other"}, ground={})
    assert crowded(fixed, {**BALL, "name": "other", "position": [0, 0, 0.101]})


def test_the_ground_is_near_to_what_is_above_it() -> None:
    assert crowded({**BALL, "position": [0, 0, 0.1]}, ground={"height": 1e-6})
    assert not crowded({**BALL, "position": [0, 0, 0.5]}, ground={})


@pytest.mark.parametrize(
    ("shape", "dimensions", "expected"),
    [
        ("box", [0.2, 0.4, 0.6], (0.4, 0.6, 0.2)),
        ("cylinder", [0.6, 0.1], (0.2, 0.6, 0.2)),
        ("sphere", [0.1], (0.2, 0.2, 0.2)),
    ],
)
def test_the_extent_of_a_turned_object(
    shape: str, dimensions: list[float], expected: tuple[float, ...]
) -> None:
    one = read_object({"name": "a", "shape_type": shape, "dimensions": dimensions, "mass": 1})
    # z to y, y to x, x to z
    rotation = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    found = bounding_box(one.chain, (), Pose((1.0, 2.0, 3.0), rotation))
    assert [high - low for low, high in found] == pytest.approx(expected)
    assert [(high + low) / 2 for low, high in found] == pytest.approx((1, 2, 3))


def test_a_bent_chain_is_where_it_is_bent_to() -> None:
    chain = scene_from_text(json.dumps(BODY)).manipulators[0].compiled.chain
    straight = bounding_box(chain, [0.0] * 4, Pose())
    bent = bounding_box(chain, [-0.4] * 4, Pose())  # about x: towards +y
    assert straight[2] == pytest.approx((0, chain.length))
    assert straight[1] == pytest.approx((-0.0085, 0.0085))
    assert bent[0] == pytest.approx(straight[0])
    assert bent[1][1] > 0.03
    assert bent[2][1] < chain.length


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_many_bodies_in_a_row_are_compared_with_their_neighbours_only(axis: int) -> None:
    def boxes(last: float) -> list[tuple[BoundingBox, bool]]:
        places = [*map(float, range(5000)), last]
        ranges = [
            [(-0.4, 0.4)] * axis + [(x - 0.4, x + 0.4)] + [(-0.4, 0.4)] * (2 - axis) for x in places
        ]
        return [(tuple(one), False) for one in ranges]

    started = time.process_time()
    assert not _do_any_intersect(boxes(5000.0))
    assert _do_any_intersect(boxes(2500.7))
    assert time.process_time() - started < 1.0  # s; all pairs take ten


def test_boxes_intersect_as_each_pair_does() -> None:
    chance = random.Random(5)
    for _ in range(300):
        boxes: list[tuple[BoundingBox, bool]] = []
        for _ in range(chance.randint(0, 7)):
            lows = [chance.uniform(0, 3) for _ in range(3)]
            box = tuple((low, low + chance.uniform(0, 1)) for low in lows)
            boxes.append((box, chance.random() < 0.5))
        boxes.append((((math.nan, math.nan),) * 3, False))  # without a shape
        chance.shuffle(boxes)
        every = any(
            _boxes_intersect(one, other)
            for (one, is_held), (other, is_other_held) in itertools.combinations(boxes, 2)
            if not (is_held and is_other_held)
        )
        assert _do_any_intersect(boxes) == every
