"""Links of one manipulator that meet each other."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import BOX, CAPSULE, STADIUM, Data, actuator, hinge, manipulator
from tests.builders.runs import columns_of, rows_of
from tests.builders.scenes import scene_from_text

pytest.importorskip("pybullet")

JOINT = hinge(1, 0, 0, spring_stiffness=0.05, spring_damping=0.02, limits=[-3, 3, 10, 10])


def finger(link: Data, torque: float, collides: bool, count: int = 12) -> dict[str, np.ndarray]:
    """Return the columns over two seconds of a weightless finger that a torque rolls up."""
    one: dict[str, Any] = {
        "definition": manipulator(actuator(count, JOINT, link=link), world_scale=20),
        "actuation": [{"actuator": 0, "axis": 0, "waypoints": [[0, 0], [1.5, torque]]}],
        "self_collision": collides,
    }
    record = {"every": 10, "columns": ["joint_angles", "tip_position", "contact_force"]}
    scene = {"gravity": [0, 0, 0], "manipulators": [one], "record": record}
    return columns_of(scene_from_text(json.dumps(scene)), 2000)


LINK = {"shape_type": "box", "dimensions": [0.02, 0.01, 0.02], "mass": 0.01}


def turned(found: dict[str, np.ndarray]) -> float:
    return float(sum(column[-1] for name, column in found.items() if name.endswith("angle_rad")))


@pytest.mark.slow
def test_a_finger_that_curls_onto_its_base_is_stopped_by_it() -> None:
    # 12 joints of up to 0.8 rad each would be more than a turn
    free, stopped = (finger(LINK, 0.04, collides) for collides in (False, True))
    assert turned(free) > 8.5
    assert 2 * np.pi < turned(stopped) < 7.6
    # what a body does to itself is no force on it
    assert stopped["body.contact.normal_n"][-1] == 0


@pytest.mark.parametrize("link", [BOX, CAPSULE, STADIUM], ids=["box", "capsule", "stadium"])
@pytest.mark.parametrize("torque", [0.0, 0.01])
def test_a_chain_that_does_not_meet_itself_feels_nothing(link: Data, torque: float) -> None:
    free, able = (finger(link, torque, collides, 6) for collides in (False, True))
    for name, column in free.items():
        assert (able[name] == column).all(), name


def test_limbs_that_bend_towards_each_other_meet() -> None:
    """Two fingers 6 cm apart, whose tips would pass each other."""
    limb = manipulator(actuator(4, JOINT, link=LINK))
    assembly = {
        "assembly_name": "pair",
        "world_scale": 20,
        "body_definition": {"shape_type": "box", "dimensions": [0.02, 0.1, 0.02], "mass": 0.1},
        "limbs": [
            {"name": "left", "definition": limb, "position": [0, -0.03, 0.02]},
            {"name": "right", "definition": limb, "position": [0, 0.03, 0.02]},
        ],
    }
    apart = []
    for collides in (False, True):
        drives = [("left", -0.03), ("right", 0.03)]
        one = {
            "definition": assembly,
            "actuation": [
                {"limb": name, "actuator": 0, "axis": 0, "waypoints": [[0, 0], [0.5, torque]]}
                for name, torque in drives
            ],
            "self_collision": collides,
        }
        scene = {
            "gravity": [0, 0, 0],
            "manipulators": [one],
            "record": {"columns": ["tip_position"]},
        }
        plan = make_plan(scene_from_text(json.dumps(scene)))
        row = dict(zip(columns.header(plan.recorded), rows_of(plan, 1000)[-1], strict=True))
        apart.append(row["pair.right_tip.y_m"] - row["pair.left_tip.y_m"])
    assert apart[0] < -0.01
    assert apart[1] > 0
