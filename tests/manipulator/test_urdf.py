from __future__ import annotations

import dataclasses
import random
import re
import xml.etree.ElementTree as ET
from typing import Any

import pytest

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.definition import MAXIMUM_JOINTS
from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.manipulator.urdf import number, render, render_for_engine
from tests.builders.definitions import (
    BOX,
    CAPSULE,
    CYLINDER,
    EVERYTHING,
    SPHERE,
    STADIUM,
    X,
    Y,
    actuator,
    chain_of,
    compiled,
    hinge,
    manipulator,
)
from tests.builders.urdf_in_bullet import in_bullet

SMALL = """\
<?xml version="1.0" encoding="utf-8"?>
<robot name="body">
  <material name="red">
    <color rgba="1 0 0 0.5" />
  </material>
  <link name="base">
    <inertial>
      <origin xyz="0 0 0.25" rpy="0 0 0" />
      <mass value="1" />
      <inertia ixx="0.10416666666666669" ixy="0" ixz="0" iyy="0.10416666666666669" iyz="0" \
izz="0.16666666666666669" />
    </inertial>
    <visual>
      <origin xyz="0 0 0.25" rpy="0 0 0" />
      <geometry>
        <box size="2 2 1" />
      </geometry>
      <material name="red" />
    </visual>
    <collision>
      <origin xyz="0 0 0.25" rpy="0 0 0" />
      <geometry>
        <box size="1 1 0.5" />
      </geometry>
    </collision>
  </link>
  <joint name="actuator_0_joint_01" type="revolute">
    <parent link="base" />
    <child link="actuator_0_segment_01" />
    <origin xyz="0 0 0.5" rpy="0 0 0" />
    <axis xyz="0 1 0" />
    <limit lower="-1" upper="1.5" effort="10" velocity="0.001" />
    <dynamics damping="1e-05" friction="0.25" />
  </joint>
  <link name="actuator_0_segment_01">
    <inertial>
      <origin xyz="0 0 0.25" rpy="0 0 0" />
      <mass value="1" />
      <inertia ixx="0.10416666666666669" ixy="0" ixz="0" iyy="0.10416666666666669" iyz="0" \
izz="0.16666666666666669" />
    </inertial>
    <visual>
      <origin xyz="0 0 0.25" rpy="0 0 0" />
      <geometry>
        <box size="2 2 1" />
      </geometry>
      <material name="red" />
    </visual>
    <collision>
      <origin xyz="0 0 0.25" rpy="0 0 0" />
      <geometry>
        <box size="1 1 0.5" />
      </geometry>
    </collision>
  </link>
  <gazebo reference="actuator_0_joint_01">
    <springStiffness>3</springStiffness>
    <springReference>0.1</springReference>
    <implicitSpringDamper>true</implicitSpringDamper>
  </gazebo>
</robot>
"""


@pytest.fixture(scope="module")
def everything() -> Chain:
    return chain_of(EVERYTHING)


def robot_of(chain: Chain, **options: Any) -> ET.Element:
    return ET.fromstring(render(chain, **options))


def floats(text: str | None) -> tuple[float, ...]:
    return tuple(float(word) for word in (text or "").split())


def test_the_text() -> None:
    joint = hinge(
        0, 2, 0,
        limits=[-1, 1.5, 10, 0.001],
        spring_stiffness=3,
        spring_damping=1e-5,
        joint_neutral_position=0.1,
        joint_control_limit_force=0.25,
    )  # fmt: skip
    link = {
        "shape_type": "box",
        "dimensions": [1, 1, 1],
        "mass": 2,
        "material_color": [1, 0, 0, 0.5],
        "material_name": "red",
        "visual_geometry_scaling_factor": 2,
    }
    assert render(chain_of(manipulator(actuator(1, joint, link=link)))) == SMALL


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (1, "1"),
        (-2.0, "-2"),
        (0.1, "0.1"),
        (1e-5, "1e-05"),
        (1e16, "1e+16"),
        (1e22, "1e+22"),
        (0.1 + 0.2, "0.30000000000000004"),
        (123456.0, "123456"),
    ],
)
def test_numbers_are_as_short_as_can_be(value: float, text: str) -> None:
    assert number(value) == text


def test_numbers_read_back_exactly() -> None:
    dice = random.Random(1)
    for _ in range(1000):
        value = dice.uniform(-1, 1) * 10 ** dice.uniform(-20, 20)
        assert float(number(value)) == value


def test_every_number_of_the_chain_is_in_the_file(everything: Chain) -> None:
    robot = robot_of(everything)
    for link, element in zip(everything.links, robot.findall("link"), strict=True):
        inertial = element.find("inertial")
        assert inertial is not None
        assert floats(inertial.find("origin").get("xyz")) == link.inertial.centre
        assert float(inertial.find("mass").get("value")) == link.inertial.mass
        six = inertial.find("inertia").attrib
        assert list(six) == ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
        assert tuple(map(float, six.values())) == link.inertial.inertia
        for kind in ("visual", "collision"):
            for shape, item in zip(link.shapes, element.findall(kind), strict=True):
                assert floats(item.find("origin").get("xyz")) == shape.position
                assert floats(item.find("origin").get("rpy")) == shape.rpy
    for place, (joint, element) in enumerate(
        zip(everything.joints, robot.findall("joint"), strict=True)
    ):
        assert element.find("parent").get("link") == everything.links[place].name
        assert element.find("child").get("link") == everything.links[place + 1].name
        assert floats(element.find("origin").get("xyz")) == joint.origin
        assert floats(element.find("axis").get("xyz")) == joint.axis
        dynamics = element.find("dynamics")
        assert float(dynamics.get("damping")) == joint.damping
        assert float(dynamics.get("friction")) == joint.friction
        limit = element.find("limit")
        if joint.is_limited:
            assert element.get("type") == "revolute"
            four = (joint.lower, joint.upper, joint.effort, joint.velocity)
            assert tuple(map(float, limit.attrib.values())) == four
        else:
            assert element.get("type") == "continuous"
            assert limit is None


def test_springs_are_in_the_tags_of_gazebo(everything: Chain) -> None:
    elements = robot_of(everything).findall("gazebo")
    assert [element.get("reference") for element in elements] == [
        joint.name for joint in everything.joints
    ]
    for joint, element in zip(everything.joints, elements, strict=True):
        assert float(element.findtext("springStiffness")) == joint.stiffness
        assert float(element.findtext("springReference")) == joint.neutral_position
        assert element.findtext("implicitSpringDamper") == "true"


def test_shapes_have_their_sizes(everything: Chain) -> None:
    found = {item.tag for item in robot_of(everything).iterfind(".//collision/geometry/*")}
    assert found == {"box", "cylinder", "sphere"}
    chain = chain_of(manipulator(actuator(1, X, link=CAPSULE), tip_definition=SPHERE))
    robot = robot_of(chain)
    cylinder, sphere, _ = robot.findall(".//collision/geometry/*")[:3]
    assert cylinder.attrib == {"length": "0.01", "radius": "0.01"}
    assert sphere.attrib == {"radius": "0.01"}


def test_a_name_for_two_colours_gets_a_number() -> None:
    red, blue, grey = [1, 0, 0, 1], [0, 0, 1, 1], [0.6, 0.6, 0.6, 1]
    parts = [
        {**BOX, "material_color": red, "material_name": "paint"},
        {**BOX, "material_color": blue, "material_name": "paint"},
        {**BOX, "material_color": red, "material_name": "paint"},
        {**BOX, "material_color": red, "material_name": "paint_2"},
        BOX,
    ]
    actuators = [actuator(1, X, link=part) for part in parts]
    robot = robot_of(chain_of(manipulator(*actuators)))
    colours = {
        item.get("name"): list(floats(item.find("color").get("rgba")))
        for item in robot.findall("material")
    }
    assert colours == {"paint": red, "paint_2": blue, "paint_2_2": red, "grey": grey}
    used = {item.get("name") for item in robot.iterfind(".//visual/material")}
    assert used == set(colours)


def test_names_are_unique(everything: Chain) -> None:
    robot = robot_of(everything, tip_frame="tip")
    for kind in ("link", "joint", "material"):
        names = [element.get("name") for element in robot.findall(kind)]
        assert len(names) == len(set(names))


def test_the_chain_is_written_from_base_to_tip(everything: Chain) -> None:
    seen = set()
    for element in robot_of(everything):
        if element.tag == "link":
            seen.add(element.get("name"))
        if element.tag == "joint":
            assert element.find("parent").get("link") in seen
            assert element.find("child").get("link") not in seen


def test_no_line_is_cut_by_the_engine() -> None:
    chain = chain_of(manipulator(actuator(MAXIMUM_JOINTS, X, Y, link=STADIUM)))
    text = render(scaled(chain, Scale(1 / 3, 1 / 7)))
    assert max(map(len, text.splitlines())) < 8000
    assert len(ET.fromstring(text).findall("joint")) == MAXIMUM_JOINTS
    with in_bullet(text) as (bullet, client, body):
        assert bullet.getNumJoints(body, physicsClientId=client) == MAXIMUM_JOINTS


def test_a_tip_frame_is_fixed_to_the_tip_and_weighs_nothing(everything: Chain) -> None:
    with_frame, without = robot_of(everything, tip_frame="tip"), robot_of(everything)
    link, joint = with_frame.findall("link")[-1], with_frame.findall("joint")[-1]
    assert (link.get("name"), list(link)) == ("tip", [])
    assert (joint.get("name"), joint.get("type")) == ("tip_joint", "fixed")
    assert joint.find("parent").get("link") == everything.links[-1].name
    assert joint.find("child").get("link") == "tip"
    assert floats(joint.find("origin").get("xyz")) == everything.tip
    with_frame.remove(link)
    with_frame.remove(joint)
    # indentation aside, nothing else differs
    bare = [re.sub(r"\s+", " ", ET.tostring(r, "unicode")) for r in (with_frame, without)]
    assert bare[0] == bare[1]


@pytest.mark.parametrize("with_collisions", [True, False])
def test_the_engine_gets_bodies_and_joints_only(everything: Chain, with_collisions: bool) -> None:
    full = robot_of(everything)
    bare = ET.fromstring(render_for_engine(everything, with_collisions))
    assert {element.tag for element in bare} == {"link", "joint"}
    assert bare.findall(".//visual") == bare.findall(".//dynamics") == []
    shapes = len(full.findall(".//collision")) if with_collisions else 0
    assert len(bare.findall(".//collision")) == shapes
    for path in ("link/inertial/*", "joint/origin", "joint/axis", "joint/limit"):
        pairs = zip(full.findall(path), bare.findall(path), strict=True)
        assert all(one.attrib == other.attrib for one, other in pairs)


def reversed_keys(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: reversed_keys(item) for key, item in reversed(value.items())}
    return [reversed_keys(item) for item in value] if isinstance(value, list) else value


def test_the_same_bytes_every_time_whatever_the_order_of_keys() -> None:
    other = reversed_keys(EVERYTHING)
    assert list(other) != list(EVERYTHING)
    texts = {compiled(data).urdf(Scale(20)) for data in (EVERYTHING, other, EVERYTHING)}
    assert len(texts) == 1
    assert "\r" not in texts.pop()


def test_it_ends_with_a_line_break_and_is_plain_ascii(everything: Chain) -> None:
    text = render(everything)
    assert text.isascii()
    assert text.endswith("</robot>\n")
    assert text.startswith('<?xml version="1.0" encoding="utf-8"?>\n')


def test_a_visual_factor_does_not_touch_what_collides() -> None:
    link = {**CYLINDER, "visual_geometry_scaling_factor": 3}
    robot = robot_of(chain_of(manipulator(actuator(1, X, link=link))))
    assert robot.find(".//visual/geometry/cylinder").attrib == {"length": "0.03", "radius": "0.03"}
    assert robot.find(".//collision/geometry/cylinder").attrib == {
        "length": "0.01",
        "radius": "0.01",
    }


def test_the_engine_holds_the_numbers_of_the_chain(everything: Chain) -> None:
    chain = dataclasses.replace(scaled(everything, Scale(20)))
    with in_bullet(render(chain)) as (bullet, client, body):
        assert bullet.getNumJoints(body, physicsClientId=client) == len(chain.joints)
        for place, (link, joint) in enumerate(zip(chain.links[1:], chain.joints, strict=True)):
            state = bullet.getDynamicsInfo(body, place, physicsClientId=client)
            assert state[0] == pytest.approx(link.inertial.mass, rel=1e-12)
            assert state[3] == pytest.approx(link.inertial.centre, rel=1e-9, abs=1e-12)
            known = bullet.getJointInfo(body, place, physicsClientId=client)
            assert known[1].decode() == joint.name
            assert known[12].decode() == link.name
            assert known[6] == joint.damping
