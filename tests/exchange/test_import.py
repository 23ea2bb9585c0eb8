"""Definitions that are found in models: those of all our own, models of others, and refusals."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from somo_cli.document.parse import parse
from somo_cli.exchange import mjcf, sdf
from somo_cli.exchange.imported import Imported, import_model, require_same
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
from tests.builders.shipped import SHIPPED_CHAINS, shipped_document

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
