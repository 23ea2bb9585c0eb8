"""The one place where SI becomes engine units."""

from __future__ import annotations

import dataclasses
import json
import xml.etree.ElementTree as ET
from typing import Any

import pytest

from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.manipulator.urdf import render_for_engine
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import EVERYTHING, X, Y, Z, actuator, manipulator
from tests.builders.scenes import scene_from_text

ONE = {
    "name": "one",
    "definition": EVERYTHING,
    "position": [1, 2, 3],
    "rpy": [0.1, 0.2, 0.3],
    "base": "free",
    "linear_velocity": [4, 5, 6],
    "angular_velocity": [7, 8, 9],
    "initial_angles": 0.25,
    "initial_rates": 0.5,
    "actuation": [{"actuator": 0, "axis": 0, "waypoints": [[0, 1], [2, 3]]}],
    "loads": [
        {
            "link": "base",
            "point": [1, 2, 3],
            "force": [4, 5, 6],
            "moment": [7, 8, 9],
            "frame": "body",
            "waypoints": [[0, 1], [2, 3]],
        }
    ],
}


def scene(*manipulators: dict[str, Any], **more: Any) -> Scene:
    return scene_from_text(json.dumps({"manipulators": manipulators or [ONE], **more}))


def plan(*manipulators: dict[str, Any], **more: Any) -> Plan:
    return make_plan(scene(*manipulators, **more))


def test_without_a_scale_everything_is_si() -> None:
    found = plan(gravity=[1, 2, 3], time_step=0.002, integrator="euler", record={"every": 3})
    assert (found.gravity, found.time_step, found.integrator) == ((1.0, 2.0, 3.0), 0.002, "euler")
    assert (found.every, found.columns) == (3, ("joint_angles", "tip_position", "base_pose"))
    body = found.bodies[0]
    assert body.start.position == (1.0, 2.0, 3.0)
    assert body.drives[0].signal.at(1.0) == 2.0
    assert (body.name, body.base) == ("one", "free")


@pytest.mark.parametrize(("length", "mass"), [(20.0, 1.0), (8.0, 1000.0), (0.5, 0.1)])
def test_everything_is_scaled_by_its_dimension(length: float, mass: float) -> None:
    si, found = plan(), plan(world_scale={"length": length, "mass": mass})
    assert found.scale == Scale(length, mass)
    assert found.time_step == si.time_step
    assert found.gravity == pytest.approx([length * value for value in si.gravity])
    body, of_si = found.bodies[0], si.bodies[0]
    start = body.start
    (load,) = body.loads
    force, torque = mass * length, mass * length**2
    assert load.point == pytest.approx((length, 2 * length, 3 * length))
    assert load.force == pytest.approx((4 * force, 5 * force, 6 * force))
    assert load.moment == pytest.approx((7 * torque, 8 * torque, 9 * torque))
    assert (load.link, load.frame, load.signal.at(1.0)) == (0, "body", 2.0)
    assert start.position == pytest.approx((length, 2 * length, 3 * length))
    assert start.linear_velocity == pytest.approx((4 * length, 5 * length, 6 * length))
    assert start.rpy == of_si.start.rpy
    assert start.angular_velocity == of_si.start.angular_velocity
    assert start.angles == of_si.start.angles == (0.25,) * len(body.chain.joints)
    assert start.rates == of_si.start.rates == (0.5,) * len(body.chain.joints)
    torque = mass * length**2
    assert body.drives[0].signal.at(1.0) == pytest.approx(2.0 * torque)
    assert body.drives[0].signal.times == of_si.drives[0].signal.times
    for joint, joint_si in zip(body.chain.joints, of_si.chain.joints, strict=True):
        assert joint.stiffness == pytest.approx(joint_si.stiffness * torque)
        assert joint.damping == pytest.approx(joint_si.damping * torque)
    assert body.chain == scaled(of_si.chain, found.scale)


def test_the_urdf_is_that_of_the_scaled_chain() -> None:
    body = plan(world_scale=20).bodies[0]
    assert body.urdf == render_for_engine(body.chain, with_collisions=False)


def test_the_engine_knows_limits_where_the_law_alone_may_miss_them() -> None:
    alone = {"definition": manipulator(actuator(2, X))}
    (body,) = plan(alone).bodies
    assert not body.has_engine_limits
    assert 'type="continuous"' in body.urdf
    assert "revolute" not in body.urdf
    (free,) = plan(alone | {"base": "free"}).bodies
    (explicit,) = plan(alone, integrator="explicit").bodies
    (pushed,) = plan(alone, ground={"height": 0}).bodies
    assert all(one.has_engine_limits for one in (free, explicit, pushed))
    assert not any(one.has_zero_torque_motors for one in (body, free, explicit, pushed))


def tags(text: str) -> set[str]:
    return {element.tag for element in ET.fromstring(text).iter()}


def test_what_can_touch_nothing_has_no_shapes() -> None:
    (alone,) = plan().bodies
    assert tags(alone.urdf).isdisjoint({"collision", "visual", "geometry", "gazebo", "dynamics"})
    two = plan(ONE, {**ONE, "name": "two"}).bodies
    for body in two:
        assert "collision" in tags(body.urdf)
        assert tags(body.urdf).isdisjoint({"visual", "gazebo", "dynamics"})
        count = sum(len(link.shapes) for link in body.chain.links)
        assert len(ET.fromstring(body.urdf).findall("link/collision")) == count


def test_the_engine_has_no_tip_frame() -> None:
    (body,) = plan().bodies
    names = [link.get("name") for link in ET.fromstring(body.urdf).findall("link")]
    assert names == [link.name for link in body.chain.links]


def test_a_drive_acts_on_the_joints_of_its_actuator_and_axis() -> None:
    fixed = {"joint_type": "fixed"}
    definition = manipulator(
        actuator(5, X, Y), actuator(4, X, Y, Z), actuator(2, X), actuator(4, X, fixed)
    )
    entries = [(0, 0), (0, 1), (1, 0), (1, 1), (1, 2), (2, 0), (3, 0)]
    actuation = [{"actuator": a, "axis": x, "torque": 1} for a, x in reversed(entries)]
    (body,) = plan({"definition": definition, "actuation": actuation}).bodies
    drives = {(drive.actuator, drive.axis): drive.joints for drive in body.drives}
    assert drives == {
        (0, 0): (0, 2, 4),
        (0, 1): (1, 3),
        (1, 0): (5, 8),
        (1, 1): (6,),
        (1, 2): (7,),
        (2, 0): (9, 10),
        (3, 0): (11, 12),
    }


def test_bodies_keep_the_order_of_the_scene() -> None:
    found = plan(*({"name": name, "definition": EVERYTHING} for name in ("b", "c", "a")))
    assert [body.name for body in found.bodies] == ["b", "c", "a"]


def test_planning_changes_nothing_of_the_scene() -> None:
    wanted = scene(world_scale=20)
    before = dataclasses.replace(wanted)
    assert make_plan(wanted) == make_plan(wanted)
    assert wanted == before
