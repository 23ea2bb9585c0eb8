"""What can never touch: never where anything could, and worth what a scene of its own is."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.scene.extents import max_height
from somo_cli.scene.reach import can_touch, reach
from somo_cli.simulation import plan_report
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import EVERYTHING, Data, X, Y, actuator, chain_of, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text

BODY = manipulator(actuator(4, X, Y))
BALL: Data = {"name": "ball", "shape_type": "sphere", "dimensions": [0.1], "mass": 1}
FIXED = {**BALL, "fixed": True}


def touching(*others: Data, one: Data | None = None, **of_scene: Any) -> bool:
    data = {"manipulators": [{"definition": BODY, **(one or {})}, *others], **of_scene}
    return can_touch(scene_from_text(json.dumps(data)))


@pytest.mark.parametrize("definition", [BODY, EVERYTHING])
def test_nothing_gets_farther_than_the_reach(definition: Data) -> None:
    chain = chain_of(definition)
    random = np.random.default_rng(3)
    base = Pose.of((0.0, 0.0, 0.0), (0.3, -0.8, 1.2))
    farthest = 0.0
    for _ in range(50):
        angles = random.uniform(-3.1, 3.1, len(chain.joints)).tolist()
        for link, pose in zip(chain.links, link_poses(chain, angles, base), strict=True):
            for shape in link.shapes:
                farthest = max(farthest, max_height(shape, pose))
    assert 0.3 * reach(chain) < farthest <= reach(chain)
    assert reach(chain) >= chain.length


def test_manipulators_that_are_far_apart_cannot_touch() -> None:
    apart = 2 * reach(chain_of(BODY)) + 0.05
    for place in ([1, 0, 0], [0, -1, 0], [0.6, -0.8, 0], [0.6, 0.64, -0.48]):
        beside = {"definition": BODY, "name": "b"}
        assert not touching({**beside, "position": [apart * one for one in place]})
        assert touching({**beside, "position": [0.9 * apart * one for one in place]})
    assert not touching()


def test_what_may_go_anywhere_can_touch_what_is_far() -> None:
    far = {"definition": BODY, "name": "b", "position": [99, 0, 0]}
    assert not touching(far)
    assert touching({**far, "base": "free"})
    assert touching({**far, "base": "constrained"})
    assert touching(far, one={"self_collision": True})
    assert touching(objects=[{**BALL, "position": [99, 0, 0]}])
    moved = {"translation": [[0, 0, 0, 0], [1, 0, 0, 1]]}
    assert touching(objects=[{**BALL, "position": [99, 0, 0], "motion": moved}])


def test_what_is_fixed_can_be_out_of_reach() -> None:
    clear = reach(chain_of(BODY)) + 0.1
    assert touching(objects=[{**FIXED, "position": [0, 0, clear - 0.01]}])
    assert not touching(objects=[{**FIXED, "position": [0, 0, clear + 0.03]}])
    # objects that are fixed touch each other for nothing
    two = [{**FIXED, "name": name, "position": [0, 0, 2 * clear]} for name in ("c", "d")]
    assert not touching(objects=two, ground={"height": -9})


def test_the_ground_can_be_out_of_reach() -> None:
    down = -reach(chain_of(BODY))
    assert touching(ground={"height": down + 0.01})
    assert not touching(ground={"height": down - 0.03})
    assert not touching(ground={"height": 1 + down - 0.03}, one={"position": [0, 0, 1]})
    # an object on the ground is where the ground is
    placed = {**FIXED, "place": {"on": "ground"}}
    assert not touching(objects=[placed], ground={"height": -9})


def test_fingers_out_of_reach_move_as_each_would_alone() -> None:
    pytest.importorskip("pybullet")
    bodies = [
        {"definition": "finger.yaml", "name": "a", "initial_angles": 0.1},
        {"definition": "finger.yaml", "name": "b", "position": [1, 0, 0], "initial_angles": -0.2},
    ]

    def angles(*some: Data, keeps_unused: bool = False) -> list[list[float]]:
        record = {"columns": ["joint_angles", "tip_position"]}
        data = {"manipulators": some, "ground": {"height": -1}, "record": record}
        scene = scene_from_text(json.dumps(data))
        plan = make_plan(scene, keeps_unused)
        kept = [one.is_kept for one in plan_report.explain(plan) if one.what == "collision shapes"]
        assert kept == [keeps_unused]
        columns = 3 + len(plan.bodies[0].chain.joints)
        return [row[1 : 1 + columns * len(some)] for row in rows_of(plan, 80)]

    both = angles(*bodies)
    alone = [angles(one) for one in bodies]
    assert both == [[*a, *b] for a, b in zip(*alone, strict=True)]
    assert angles(*bodies, keeps_unused=True) == both
