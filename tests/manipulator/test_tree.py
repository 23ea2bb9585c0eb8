"""An assembly as one tree: names, poses, and what is lumped into the body, exactly."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
import pytest

from somo_cli.manipulator import geometry, kinematics
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import Compiled, compile_definition
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.urdf import render
from somo_cli.manipulator.urdf_readback import require_equal
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from tests.builders.assemblies import ALONE, BEND, BODY, PLACES, assembly_of
from tests.builders.definitions import (
    CAPSULE,
    X,
    actuator,
    compiled,
    document_of,
    manipulator,
)
from tests.builders.mujoco_reference import mujoco_model
from tests.builders.urdf_in_bullet import bullet_mass_matrix


@pytest.fixture(scope="module")
def whole() -> Compiled:
    return compiled(assembly_of())


def angles_of(chain: Chain, seed: int = 3) -> list[float]:
    return np.random.default_rng(seed).uniform(-0.6, 0.6, len(chain.joints)).tolist()


def total(chain: Chain, poses: tuple[Pose, ...]) -> tuple[float, np.ndarray, np.ndarray]:
    """Return mass, first moment and inertia about the world's origin of all links."""
    mass, moment, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    for link, pose in zip(chain.links, poses, strict=True):
        own = link.inertial
        at = np.array(pose.point(own.centre))
        turn = np.array(pose.rotation)
        xx, xy, xz, yy, yz, zz = own.inertia
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        mass += own.mass
        moment += own.mass * at
        inertia += turn @ tensor @ turn.T + own.mass * (at @ at * np.eye(3) - np.outer(at, at))
    return mass, moment, inertia


def test_names_and_parents_in_the_order_of_the_limbs(whole: Compiled) -> None:
    chain = whole.chain
    assert [joint.name for joint in chain.joints] == [
        *(f"left_actuator_0_joint_0{i}" for i in (1, 2, 3, 4)),
        *(f"right_actuator_0_joint_0{i}" for i in (1, 2)),
        *(f"right_actuator_1_joint_0{i}" for i in (1, 2, 3)),
        *(f"mid_1_actuator_0_joint_0{i}" for i in (1, 2, 3, 4)),
    ]
    assert chain.links[0].name == "base"
    assert [link.name for link in chain.links[1:]] == [
        joint.name.replace("joint", "segment") for joint in chain.joints
    ]
    assert [joint.parent for joint in chain.joints] == [0, 1, 2, 3, 0, 5, 6, 7, 8, 0, 10, 11, 12]
    assert [joint.actuator for joint in chain.joints] == [0] * 4 + [1] * 2 + [2] * 3 + [3] * 4
    assert [limb.last_link for limb in chain.limbs] == [4, 9, 13]
    assert [chain.backbone_of(chain.joints[i]).name for i in (0, 4, 8, 9)] == [
        "left",
        "right",
        "right",
        "mid_1",
    ]
    assert chain.length == max(compiled(one).chain.length for one in ALONE.values())


def test_every_limb_is_where_it_would_be_alone(whole: Compiled) -> None:
    chain, base = whole.chain, Pose.of((0.1, 0.2, 0.3), (0.3, -0.4, 1.2))
    angles = angles_of(chain)
    poses = kinematics.link_poses(chain, angles, base)
    for limb in chain.limbs:
        at, rpy = PLACES[limb.name]
        own = base.compose(Pose.of(at, rpy))
        alone = compiled(ALONE[limb.name]).chain
        expected = kinematics.link_poses(alone, angles[limb.first : limb.last], own)[1:]
        found = poses[limb.first + 1 : limb.last + 1]
        for one, other in zip(found, expected, strict=True):
            assert one.position == pytest.approx(other.position, abs=1e-15)
            assert np.allclose(one.rotation, other.rotation, atol=1e-14)
        tip = poses[limb.last_link].point(limb.tip)
        assert tip == pytest.approx(expected[-1].point(alone.tip), abs=1e-15)


def test_mass_and_inertia_are_the_sum_of_the_parts(whole: Compiled) -> None:
    chain, base = whole.chain, Pose.of((0.1, 0.2, 0.3), (0.3, -0.4, 1.2))
    angles = angles_of(chain)
    found = total(chain, kinematics.link_poses(chain, angles, base))
    # the body by itself is a manipulator's base; its first joint holds nothing but what it has
    body = compiled(manipulator(actuator(1, X), base_definition=BODY))
    root = dataclasses.replace(body.chain, links=body.chain.links[:1], joints=())
    half = compiled(manipulator(actuator(1, X))).chain.links[0].inertial
    shift = Pose((0.0, 0.0, 0.03))
    sums = list(total(root, (base,)))
    halves = dataclasses.replace(
        root, links=(dataclasses.replace(root.links[0], inertial=half),), joints=()
    )
    minus = total(halves, (Pose(base.point(shift.position), base.rotation),))
    parts = [np.subtract(one, other) for one, other in zip(sums, minus, strict=True)]
    for limb in chain.limbs:
        at, rpy = PLACES[limb.name]
        own = base.compose(Pose.of(at, rpy))
        alone = compiled(ALONE[limb.name]).chain
        poses = kinematics.link_poses(alone, angles[limb.first : limb.last], own)
        parts = [np.add(one, other) for one, other in zip(parts, total(alone, poses), strict=True)]
    for one, other in zip(found, parts, strict=True):
        assert np.allclose(one, other, rtol=1e-13, atol=1e-16)


def test_the_shapes_of_a_limb_that_are_part_of_the_body_are_in_place(whole: Compiled) -> None:
    shapes = whole.chain.links[0].shapes
    at, rpy = PLACES["left"]
    rotation = geometry.rotation_from_rpy(rpy)
    alone = compiled(BEND).chain.links[0].shapes
    for shape, own in zip(shapes[1 : 1 + len(alone)], alone, strict=True):
        place = geometry.add(at, geometry.rotate(rotation, own.position))
        assert shape.position == pytest.approx(place, abs=1e-16)
        assert shape.rpy == pytest.approx(rpy, abs=1e-14)
        assert shape.solid == own.solid


def test_a_body_without_a_hinge_is_round_at_both_ends() -> None:
    shapes = compiled(assembly_of(body_definition=CAPSULE)).chain.links[0].shapes
    assert [shape.position[2] for shape in shapes[:3]] == pytest.approx([0.01, 0.0, 0.02])


def test_yourdfpy_reads_what_was_meant(whole: Compiled) -> None:
    require_equal(whole.urdf(Scale(20), "tcp"), whole.scaled_chain(Scale(20)))


def test_the_masses_in_motion_are_those_of_pybullet_and_mujoco(whole: Compiled) -> None:
    chain = whole.chain
    angles = angles_of(chain)
    own = ChainDynamics(chain).at(angles).joint_inertia()
    model = mujoco_model(chain, (0, 0, 0), 1e-3)
    state = mujoco.MjData(model)
    state.qpos[:] = angles
    mujoco.mj_forward(model, state)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, state, full)
    size = np.abs(own).max()
    assert np.abs(own - full).max() < 1e-12 * size
    assert np.abs(own - bullet_mass_matrix(chain, angles)).max() < 1e-9 * size
    # a body that is held parts the limbs
    assert np.abs(own[:4, 4:]).max() == np.abs(own[4:9, 9:]).max() == 0.0


def test_a_limb_at_the_body_frame_alone_is_the_manipulator_itself() -> None:
    alone = compiled(BEND).chain
    limb = {"name": "only", "definition": BEND}
    one = compiled(assembly_of(limbs=[limb])).chain
    assert [
        dataclasses.replace(joint, name=joint.name.removeprefix("only_")) for joint in one.joints
    ] == list(alone.joints)
    assert [link.inertial for link in one.links[1:]] == [link.inertial for link in alone.links[1:]]
    assert one.tip == alone.tip


def test_each_limb_has_a_tip_frame(whole: Compiled) -> None:
    text = render(whole.chain, "tcp")
    for limb in whole.chain.limbs:
        assert f'<link name="{limb.name}_tcp" />' in text


def test_an_assembly_says_how_many_limbs_it_has(whole: Compiled) -> None:
    assert (
        compile_definition(document_of(assembly_of()))
        .described(Scale())
        .startswith("3 limbs, 14 links, 13 joints, ")
    )
