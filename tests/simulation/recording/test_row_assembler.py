"""Rows of a world: what no column needs is not read, and what is picked is what all would be."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.scene.model import ALL_OBJECT_QUANTITIES, ALL_QUANTITIES
from somo_cli.simulation.plan.build import make_plan
from tests.builders.fake_run import FakeRun
from tests.builders.fake_world import FakeWorld, plan_of_hinges
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

REFUSED = {
    "base_pose": [
        *("tip_position", "tip_velocity", "tip_orientation", "base_pose"),
        *("link_positions", "link_orientations", "energy"),
    ],
    "touches": ["contact_force", "contact_pairs", "link_contact_forces"],
}


def refuse(*_: Any) -> None:
    raise AssertionError


@pytest.mark.parametrize("verb", REFUSED)
def test_what_no_column_needs_is_not_read(verb: str) -> None:
    for only in (None, ["b.*.angle_rad", "a.*.spring_torque_nm"]):
        chosen = {"columns": [one for one in ALL_QUANTITIES if one not in REFUSED[verb]]}
        record = {"every": 3, **(chosen if only is None else {"only": only})}
        plan = plan_of_hinges(2, names=("a", "b"), record=record)
        world = FakeWorld(plan)
        if verb == "touches":
            world.contact_points = refuse  # type: ignore[assignment, method-assign]
        for body in world.bodies:
            if verb == "base_pose":
                body.base_pose = refuse  # type: ignore[assignment, method-assign]
        ended = FakeRun(plan, world, 20)
        assert len(ended.rows) == 7
        assert {len(row) for row in ended.rows} == {len(columns.header(plan.recorded))}


def test_only_the_body_of_a_column_is_read() -> None:
    plan = plan_of_hinges(names=("a", "b"), record={"only": ["b.tip.z_m"]})
    world = FakeWorld(plan)
    world.bodies[0].base_pose = refuse  # type: ignore[assignment, method-assign]
    assert columns.header(plan.recorded) == ["time_s", "b.tip.z_m"]
    assert len(FakeRun(plan, world, 5).rows) == 6


PICKED = [
    "finger.tip.z_m",
    "finger.actuator_0_joint_0?.rate_rad_per_s",
    "*.contact.cube.f[xyz]_n",
    "finger.energy.gravity_j",
    "cube.pose.q*",
    "cube.velocity.y_m_per_s",
    "cube.angles.x_rad",
]


def test_what_is_picked_is_what_it_would_be_among_all() -> None:
    pytest.importorskip("pybullet")
    every = 7
    whole = {"every": every, "columns": ALL_QUANTITIES, "objects": ALL_OBJECT_QUANTITIES}
    tables = []
    for record in (whole, {"every": every, "only": PICKED}):
        scene = scene_from_file("push_scene.yaml", f"record={json.dumps(record)}", "time_step=4e-3")
        names = columns.header(make_plan(scene).recorded)
        tables.append(dict(zip(names, np.array(rows_of(scene, 250)).T, strict=True)))
    everything, picked = tables
    assert len(picked) == 1 + 1 + 9 + 3 + 1 + 4 + 1 + 1
    assert everything["cube.contact.finger.normal_n"].any()
    for name, values in picked.items():
        assert values.tolist() == everything[name].tolist(), name


def test_picks_come_in_the_order_of_all() -> None:
    text = json.dumps({"only": ["cube.*.z_m", "finger.tip.*", "finger.*_01.angle_rad"]})
    plan = make_plan(scene_from_file("push_scene.yaml", f"record={text}"))
    assert columns.header(plan.recorded) == [
        "time_s",
        "finger.actuator_0_joint_01.angle_rad",
        "finger.tip.x_m",
        "finger.tip.y_m",
        "finger.tip.z_m",
        "cube.pose.z_m",
    ]


def test_turns_are_the_quaternions_or_what_is_left_of_them() -> None:
    def turns(*only: str) -> list[list[str]]:
        plan = make_plan(scene_from_file("push_scene.yaml", f"record={json.dumps({'only': only})}"))
        names = columns.header(plan.recorded)
        return [
            [names[column] for column in turn] for turn in columns.quaternion_columns(plan.recorded)
        ]

    assert turns("cube.pose.*", "finger.*_02.q?", "finger.base_pose.[xq]*") == [
        [f"finger.actuator_0_segment_02.q{one}" for one in "xyzw"],
        [f"finger.base_pose.q{one}" for one in "xyzw"],
        [f"cube.pose.q{one}" for one in "xyzw"],
    ]
    assert turns("*.[xyz]_m", "cube.pose.q[zw]") == [["cube.pose.qz", "cube.pose.qw"]]


def test_a_scene_without_patterns_records_as_before() -> None:
    found = scene_from_text(json.dumps({"manipulators": [{"definition": "finger.yaml"}]}))
    assert (found.columns, found.object_quantities) == (("joint_angles", "tip_position"), ("pose",))
