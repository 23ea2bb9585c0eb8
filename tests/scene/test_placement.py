"""Objects that stand on others: how high, in any order."""

from __future__ import annotations

import itertools
import math

import pytest

from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.contact_surface import read_ground
from somo_cli.scene.extents import max_height, min_height
from somo_cli.scene.placement import with_heights
from somo_cli.scene.rigid_object import RigidObject, read_object
from tests.builders.definitions import Data

BOX: Data = {"name": "box", "shape_type": "box", "dimensions": [0.1, 0.2, 0.3], "mass": 1}
BALL: Data = {"name": "ball", "shape_type": "sphere", "dimensions": [0.05], "mass": 1}
PIPE: Data = {"name": "pipe", "shape_type": "cylinder", "dimensions": [0.4, 0.01], "mass": 1}


def heights(*data: Data, height: float = 0.0) -> dict[str, float]:
    found = with_heights([read_object(one) for one in data], read_ground({"height": height}))
    assert [one.name for one in found] == [one["name"] for one in data]
    return {one.name: one.position[2] for one in found}


def test_on_the_ground_and_on_each_other_in_any_order() -> None:
    stack = [
        {**BOX, "position": [3, 4, 99], "place": {"on": "ground"}},
        {**BALL, "place": {"on": "box", "gap": 0.001}},
        {**PIPE, "place": {"on": "ball"}},
    ]
    for order in itertools.permutations(stack):
        assert heights(*order, height=0.5) == pytest.approx(
            {"box": 0.65, "ball": 0.851, "pipe": 1.101}
        )


def test_x_and_y_stay() -> None:
    (found,) = with_heights(
        [read_object({**BOX, "position": [3, 4, 9], "place": {"on": "ground"}})], read_ground({})
    )
    assert found.position == pytest.approx((3, 4, 0.15))


def test_what_is_tilted_stands_on_its_lowest_point() -> None:
    tilted = {**BOX, "rpy": [math.pi / 4, 0, 0], "place": {"on": "ground"}}
    reach = (0.2 + 0.3) / 2 * math.sqrt(0.5)
    lying = {**PIPE, "rpy": [0, math.pi / 2, 0], "place": {"on": "box"}}
    assert heights(tilted, lying) == pytest.approx({"box": reach, "pipe": 2 * reach + 0.01})


def test_what_has_no_place_stays_and_can_be_stood_on() -> None:
    fixed = {**BOX, "position": [0, 0, -0.15], "fixed": True}
    assert heights(fixed, {**BALL, "place": {"on": "box"}}) == pytest.approx(
        {"box": -0.15, "ball": 0.05}
    )


@pytest.mark.parametrize("data", [BOX, BALL, PIPE])
def test_the_highest_point_is_the_lowest_of_the_mirrored(data: Data) -> None:
    one: RigidObject = read_object(data)
    (shape,) = one.chain.links[0].shapes
    pose = Pose.of((1.0, 2.0, 3.0), (0.3, -0.7, 2.0))
    # these are symmetric about their centres
    assert max_height(shape, pose) - 3 == pytest.approx(3 - min_height(shape, pose))
    assert max_height(shape, pose) > 3
