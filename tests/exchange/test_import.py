"""Definitions that are found in models: those of all our own, models of others, and refusals."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from random import Random

import pytest

from somo_cli.document.parse import parse
from somo_cli.exchange import mjcf, sdf
from somo_cli.exchange.imported import Imported, import_model, require_same
from somo_cli.exchange.mjcf_scene import render_scene
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import Compiled, compile_definition
from somo_cli.problems import InvalidFile
from tests.builders.definitions import (
    CAPSULE,
    CYLINDER,
    SPHERE,
    STADIUM,
    X,
    Y,
    actuator,
    compiled,
    hinge,
    manipulator,
)
from tests.builders.shipped import SHIPPED_CHAINS, shipped_document, shipped_scene

WRITERS: dict[str, Callable[[Compiled], str]] = {
    "mjcf": lambda one: mjcf.render_chain(one.chain, 1e-3),
    "sdf": lambda one: sdf.render_chain(one.chain),
    "urdf": lambda one: one.urdf(),
}


def round_trip(text: str) -> tuple[Imported, Chain]:
    """Import, compile what was found, and compare with the model that was read."""
    found = import_model(text, "model")
    chain = compile_definition(parse(found.text("model"), "found.yaml")).chain
    require_same(found, chain, "model", text)
    return found, chain


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("name", SHIPPED_CHAINS)
def test_every_shipped_definition_comes_back(name: str, kind: str) -> None:
    ours = compile_definition(shipped_document(name))
    found, chain = round_trip(WRITERS[kind](ours))
    assert len(chain.joints) == len(ours.chain.joints)
    for joint, other in zip(chain.joints, ours.chain.joints, strict=True):
        assert joint.stiffness == pytest.approx(other.stiffness, rel=1e-12)
        assert (joint.actuator, joint.channel) == (other.actuator, other.channel)
        assert joint.span == pytest.approx(other.span, rel=1e-9)
    for link, same in zip(chain.links, ours.chain.links, strict=True):
        assert link.inertial.mass == pytest.approx(same.inertial.mass, rel=1e-12)
        assert len(link.shapes) == len(same.shapes)
    assert chain.length == pytest.approx(ours.chain.length, rel=1e-12)
    assert geometry.norm(geometry.subtract(chain.tip, ours.chain.tip)) < 1e-12
    if kind == "urdf" and ours.scale is not None:
        assert found.scale == ours.scale


ROUND = manipulator(
    actuator(4, hinge(1, 0, 0, joint_neutral_position=0.1), Y, link=STADIUM),
    actuator(3, hinge(0, 1, 0, joint_type="continuous", limits=None), link=CAPSULE),
    actuator(1, X, link={**CYLINDER, "origin_offset": [0, 0, 0, 0, 0, 0.3]}),
    base_definition={**STADIUM, "mass": 0.1, "inertial_values": [2e-5, 0, 0, 3e-5, 1e-6, 4e-5]},
    tip_definitions=[{**SPHERE, "mass": 0.002}, {**CAPSULE, "mass": 0.003}],
    world_scale=1,
)


@pytest.mark.parametrize("kind", WRITERS)
def test_round_ends_neutral_angles_and_a_given_inertia_come_back(kind: str) -> None:
    ours = compiled(ROUND)
    _, chain = round_trip(WRITERS[kind](ours))
    assert [joint.neutral_position for joint in chain.joints] == [
        joint.neutral_position for joint in ours.chain.joints
    ]
    assert [len(link.shapes) for link in chain.links] == [
        len(link.shapes) for link in ours.chain.links
    ]


# models of others

FOREIGN = """
<mujoco model="other arm">
  <compiler autolimits="true" eulerseq="XYZ"/>
  <default>
    <joint stiffness="2" damping="0.01" axis="1 0 0" range="-60 60"/>
    <default class="segment"><geom type="box" size="0.01 0.02 0.05" mass="0.2"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="root" pos="1 2 3" euler="90 0 0">
      <geom type="box" size="0.01 0.02 0.025" pos="0 0 0.025" mass="0.1"/>
      <body pos="0 0 0.05" childclass="segment">
        <joint/><geom pos="0 0 0.05"/>
        <body pos="0 0 0.1" euler="0 0 90">
          <joint axis="0 -1 0" springref="10"/><geom pos="0 0 0.05" euler="0 0 -90"/>
          <body pos="0 0 0.1">
            <joint axis="0 -1 0" springref="10" ref="5"/>
            <geom pos="0 0 0.025" euler="0 0 -90" size="0.01 0.02 0.025" mass="0.1"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def test_degrees_classes_and_turned_frames_are_read() -> None:
    text = FOREIGN.replace('springref="10" ref="5"', 'springref="10"').replace(
        "<joint/>", '<joint springref="10"/>'
    )
    found, chain = round_trip(text)
    assert found.data["manipulator_name"] == "other_arm"
    (one,) = found.data["actuator_definitions"]
    assert one["n_segments"] == 3
    assert one["link_definition"]["mass"] == 0.2
    assert one["link_definition"]["dimensions"] == [0.02, 0.04, 0.1]
    for joint in chain.joints:
        assert geometry.norm(geometry.subtract(joint.axis, (1.0, 0.0, 0.0))) < 1e-12
        assert (joint.stiffness, joint.damping) == (2, 0.01)
        assert joint.upper == pytest.approx(math.pi / 3, rel=1e-12)
        assert joint.neutral_position == pytest.approx(math.pi / 18, rel=1e-12)


def test_a_reference_angle_shifts_spring_and_limits() -> None:
    _, chain = round_trip(FOREIGN)
    last = chain.joints[-1]
    assert last.neutral_position == pytest.approx(math.radians(5), rel=1e-12)
    assert last.lower == pytest.approx(math.radians(-65), rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('<joint axis="0 -1 0" springref="10"/>', '<joint type="slide"/>', "is not a hinge"),
        ('<body pos="0 0 0.1" euler="0 0 90">', '<body pos="0 0.01 0.1">', "not of one shape"),
        ("<joint/>", '<joint armature="0.1"/>', "armature has no place"),
        ("<joint/>", '<joint class="none"/>', "there is no class 'none'"),
        ('type="box" size="0.01 0.02 0.05"', 'type="capsule" size="1 1"', "geom of type 'capsule'"),
        ("<joint/>", '<joint/><frame name="f"/>', "<frame> is not read"),
        ("mujoco", "model", "<model> is no model"),
        ("</mujoco>", "", "this is not XML"),
    ],
)
def test_what_cannot_be_read_is_told_with_its_place(old: str, new: str, said: str) -> None:
    assert old in FOREIGN
    with pytest.raises(InvalidFile) as caught:
        round_trip(FOREIGN.replace(old, new))
    assert any(said in problem.message for problem in caught.value.problems)
    assert all(problem.span.source == "model" for problem in caught.value.problems)


def test_a_definition_that_is_not_the_model_is_refused() -> None:
    text = WRITERS["mjcf"](compiled(ROUND))
    mass = text.index('mass="', text.index("actuator_0_segment_03"))
    changed = text[:mass] + 'mass="9' + text[mass + 6 :]
    with pytest.raises(InvalidFile) as caught:
        round_trip(changed)
    assert "no definition that somo can find" in caught.value.problems[0].message


@pytest.mark.parametrize("kind", WRITERS)
def test_whatever_a_file_holds_it_is_read_or_refused(kind: str) -> None:
    """Numbers, attributes and elements of a model are changed at random, by a seed."""
    text = WRITERS[kind](compile_definition(shipped_document("planar_finger")))
    random = Random(kind)
    read = 0
    for _ in range(60):
        changed = damaged(text, random)
        try:
            round_trip(changed)
        except InvalidFile:
            continue  # any other error would end the test
        read += 1
    assert 5 < read < 55


def damaged(text: str, random: Random) -> str:
    """Return a text with one number replaced, or one attribute or element left out."""
    patterns = (
        (r'(?<=[ ">])-?\d[\d.e-]*(?=[ "<])', ("0", "-1", "x", "1e300", "1e-300", "1e19", "nan")),
        (r' [a-z0-9_]+="[^"]*"', ("",)),
        (r"\n *<[^<>/]*/>", ("",)),
        (r"\n *<([a-z_]+)>[^<]*</\1>", ("",)),
        (r'"[a-z_]+_[0-9a-z_]*"', ('"base"', '"actuator_0_segment_02"')),
    )
    pattern, replacements = random.choice(patterns)
    places = list(re.finditer(pattern, text))
    if not places:
        return text
    place = random.choice(places)
    return text[: place.start()] + random.choice(replacements) + text[place.end() :]


@pytest.mark.parametrize(
    ("kind", "old", "new", "said"),
    [
        ("urdf", 'child link="actuator_0_segment_02"', 'child link="base"', "form a loop"),
        (
            "urdf",
            'child link="actuator_0_segment_02"',
            'child link="actuator_0_segment_01"',
            "is the child of several joints",
        ),
        ("urdf", '<parent link="base"', '<parent link="none"', "is no link"),
        ("urdf", 'type="revolute"', 'type="prismatic"', "a joint of type 'prismatic'"),
        ("urdf", '<axis xyz="1 0 0"', '<axis xyz="0 0 0"', "has no length"),
        ("sdf", "<parent>base</parent>", "<parent>none</parent>", "is no link"),
        ("sdf", "<spring_stiffness>", "<spring_stiffness>-", "is negative"),
        ("sdf", "</model>", '</model><model name="b"/>', "there are 2 models"),
        ("sdf", 'type="revolute"', 'type="ball"', "a joint of type 'ball'"),
    ],
)
def test_what_is_wrong_in_urdf_and_sdf_is_told(kind: str, old: str, new: str, said: str) -> None:
    text = WRITERS[kind](compile_definition(shipped_document("planar_finger")))
    assert old in text
    with pytest.raises(InvalidFile) as caught:
        round_trip(text.replace(old, new, 1))
    assert any(said in problem.message for problem in caught.value.problems)


def test_a_manipulator_of_a_scene_is_taken_by_name() -> None:
    scene = shipped_scene("in_hand_scene")
    text = render_scene(scene, "hand", 1e-3)
    with pytest.raises(InvalidFile) as caught:
        import_model(text, "model")
    assert caught.value.problems[0].message == "the world has 4 bodies with hinges"
    one = scene.manipulators[2]
    found = import_model(text, "model", f"{one.name}.base")
    chain = compile_definition(parse(found.text("model"), "found.yaml")).chain
    require_same(found, chain, "model", text)
    ours = one.compiled.chain
    assert [joint.stiffness for joint in chain.joints] == [joint.stiffness for joint in ours.joints]
