from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from somo_cli.manipulator import geometry, kinematics, solids
from somo_cli.manipulator.chain import Chain, Shape
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import Box, Cylinder, Sphere
from somo_cli.manipulator.urdf import render
from tests.builders.definitions import (
    BOX,
    CAPSULE,
    CYLINDER,
    EVERYTHING,
    SPHERE,
    STADIUM,
    Data,
    X,
    Y,
    Z,
    actuator,
    bent,
    chain_of,
    hinge,
    manipulator,
)
from tests.builders.mujoco_reference import mujoco_model
from tests.builders.urdf_in_bullet import bullet_mass_matrix

FIXED: Data = {"joint_type": "fixed"}
BASE = {**BOX, "dimensions": [0.03, 0.03, 0.01], "mass": 0.1}


def masses(chain: Chain) -> list[float]:
    return [link.inertial.mass for link in chain.links]


def total_mass(chain: Chain) -> float:
    return sum(masses(chain))


def heights(chain: Chain) -> list[float]:
    """Return where each joint is along the backbone, straight."""
    places, at = [], 0.0
    for joint in chain.joints:
        at += joint.origin[2]
        places.append(at)
    return places


def solids_of(chain: Chain, link: int) -> list[object]:
    return [shape.solid for shape in chain.links[link].shapes]


def straight_poses(chain: Chain) -> tuple[Pose, ...]:
    return kinematics.link_poses(chain, [0.0] * len(chain.joints), Pose())


# what is where


def test_links_and_joints_are_named_by_place() -> None:
    chain = chain_of(manipulator(actuator(2, X), actuator(1, Y), tip_definition=SPHERE))
    assert chain.name == "body"
    assert [link.name for link in chain.links] == [
        "base",
        "actuator_0_segment_01",
        "actuator_0_segment_02",
        "actuator_1_segment_01",
    ]
    assert [joint.name for joint in chain.joints] == [
        "actuator_0_joint_01",
        "actuator_0_joint_02",
        "actuator_1_joint_01",
    ]
    assert chain_of(manipulator(actuator(100, X))).joints[4].name == "actuator_0_joint_005"


def test_joints_are_in_the_middle_of_the_length_they_stand_for() -> None:
    chain = chain_of(manipulator(actuator(3, X), base_definition=BASE))
    assert heights(chain) == pytest.approx([0.02, 0.04, 0.06], rel=1e-14)
    assert chain.length == pytest.approx(0.07, rel=1e-14)
    assert [joint.span for joint in chain.joints] == [0.02] * 3


def test_without_a_base_the_first_half_link_starts_at_the_origin() -> None:
    chain = chain_of(manipulator(actuator(2, X)))
    (root,) = chain.links[0].shapes
    assert (root.solid, root.position) == (Box((0.023, 0.017, 0.01)), (0.0, 0.0, 0.005))
    assert chain.links[0].inertial.mass == 0.0015
    assert chain.links[0].inertial.centre == (0.0, 0.0, 0.005)
    assert heights(chain) == pytest.approx([0.01, 0.03], rel=1e-14)


def test_the_tip_is_where_the_backbone_ends() -> None:
    for data in (
        manipulator(actuator(3, X)),
        manipulator(actuator(3, X), base_definition=BASE, tip_definition=SPHERE),
        EVERYTHING,
    ):
        chain = chain_of(data)
        tip = straight_poses(chain)[-1].point(chain.tip)
        assert tip == pytest.approx((0.0, 0.0, chain.length), abs=1e-15)
        base = chain.links[0].shapes[0].solid if "base_definition" in data else None
        length = base.height if base else 0.0
        for one in data["actuator_definitions"]:
            link = one["link_definition"]
            along = {"box": 2, "stadium": 2, "cylinder": 0, "capsule": 0, "sphere": 0}
            height = link["dimensions"][along[link["shape_type"]]]
            length += one["n_segments"] * (2 * height if link["shape_type"] == "sphere" else height)
        assert chain.length == pytest.approx(length, rel=1e-14)


def test_three_times_a_tenth_is_three_tenths() -> None:
    link = {**BOX, "dimensions": [0.05, 0.05, 0.1]}
    chain = chain_of(manipulator(actuator(3, X, link=link, actuator_length=0.3)))
    assert chain.length == pytest.approx(0.3, rel=1e-15)


def test_the_neutral_axis_moves_the_hinge_and_not_the_body() -> None:
    offset = [0.001, 0.006, -0.002, 0, 0, 0]
    plain = chain_of(manipulator(actuator(3, X)))
    moved = chain_of(manipulator(actuator(3, hinge(1, 0, 0, neutral_axis_offset=offset))))
    for chain in (plain, moved):
        assert chain.length == pytest.approx(0.06)
    hinges = [pose.position for pose in straight_poses(moved)[1:]]
    expected = [geometry.add(p.position, tuple(offset[:3])) for p in straight_poses(plain)[1:]]
    assert np.allclose(hinges, expected, atol=1e-16)
    for one, other in zip(centres(plain), centres(moved), strict=True):
        assert one == pytest.approx(other, abs=1e-16)


def centres(chain: Chain) -> list[geometry.Vector]:
    """Return the centre of every shape in the world, straight."""
    poses = straight_poses(chain)
    pairs = zip(poses, chain.links, strict=True)
    return [pose.point(shape.position) for pose, link in pairs for shape in link.shapes]


# planar flags, channels and fixed joints


def test_two_axes_take_turns() -> None:
    chain = chain_of(manipulator(actuator(5, X, Y)))
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    assert [joint.axis for joint in chain.joints] == [x, y, x, y, x]
    assert [joint.channel for joint in chain.joints] == [0, 1, 0, 1, 0]
    assert [joint.span for joint in chain.joints] == [0.04] * 5


def test_three_axes_take_turns() -> None:
    chain = chain_of(manipulator(actuator(5, X, Y, Z, planar_flag=0)))
    assert [joint.channel for joint in chain.joints] == [0, 1, 2, 0, 1]
    assert chain.joints[2].axis == (0.0, 0.0, 1.0)
    assert [joint.span for joint in chain.joints] == pytest.approx([0.06] * 5)


def test_one_axis_for_all() -> None:
    for changes in ({}, {"planar_flag": 1}, {"planar_flag": True}):
        chain = chain_of(manipulator(actuator(3, Y, **changes)))
        assert {joint.axis for joint in chain.joints} == {(0.0, 1.0, 0.0)}
        assert [joint.channel for joint in chain.joints] == [0, 0, 0]
        assert [joint.span for joint in chain.joints] == [0.02] * 3


def test_one_definition_per_joint() -> None:
    joints = [hinge(1, 0, 0, spring_stiffness=k, joint_neutral_position=k / 10) for k in (3, 2, 1)]
    chain = chain_of(manipulator(actuator(3, *joints, planar_flag=2)))
    assert [joint.stiffness for joint in chain.joints] == [3.0, 2.0, 1.0]
    assert [joint.neutral_position for joint in chain.joints] == pytest.approx([0.3, 0.2, 0.1])
    assert [joint.channel for joint in chain.joints] == [0, 0, 0]
    assert [joint.span for joint in chain.joints] == [0.02] * 3


def test_actuators_keep_their_numbers_across_the_seam() -> None:
    chain = chain_of(manipulator(actuator(2, X), actuator(2, Y, link=CYLINDER)))
    assert [joint.actuator for joint in chain.joints] == [0, 0, 1, 1]
    # a half box and a half cylinder, back to back, on one link
    seam = chain.links[2]
    assert solids_of(chain, 2) == [Box((0.023, 0.017, 0.01)), Cylinder(0.01, 0.01)]
    assert seam.inertial.mass == pytest.approx(0.0015 + 0.002, rel=1e-15)
    assert [shape.position[2] for shape in seam.shapes] == pytest.approx([0.005, 0.015])
    assert heights(chain) == pytest.approx([0.01, 0.03, 0.05, 0.07])


def test_fixed_joints_lump_what_they_join() -> None:
    chain = chain_of(manipulator(actuator(4, X, FIXED)))
    assert len(chain.joints) == 2
    assert heights(chain) == pytest.approx([0.01, 0.05])
    assert masses(chain) == pytest.approx([0.0015, 0.006, 0.0045])
    assert [joint.name for joint in chain.joints] == ["actuator_0_joint_01", "actuator_0_joint_03"]


def test_nothing_but_fixed_joints_is_one_body() -> None:
    chain = chain_of(manipulator(actuator(4, FIXED), base_definition=BASE, tip_definition=SPHERE))
    assert chain.joints == ()
    assert masses(chain) == pytest.approx([0.1 + 4 * 0.003 + 0.005])
    assert chain.tip == pytest.approx((0.0, 0.0, chain.length))


def test_a_continuous_joint_has_no_limits() -> None:
    free = hinge(1, 0, 0, joint_type="continuous", limits=None)
    chain = chain_of(manipulator(actuator(1, free), actuator(1, X)))
    assert [joint.is_limited for joint in chain.joints] == [False, True]


# masses and inertias


@pytest.mark.parametrize("link", [BOX, STADIUM, CYLINDER, CAPSULE, SPHERE])
@pytest.mark.parametrize("count", [1, 2, 7])
def test_half_links_have_half_the_mass(link: Data, count: int) -> None:
    chain = chain_of(manipulator(actuator(count, X, Y, link=link)))
    mass = link["mass"]
    assert masses(chain) == [mass / 2, *[mass] * (count - 1), mass / 2]
    assert total_mass(chain) == pytest.approx(count * mass, rel=1e-14)


def test_the_total_mass_is_that_of_the_parts() -> None:
    parts = 4 * 0.003 + 3 * 0.004 + 2 * 0.002 + 0.1 + 0.005 + 0.003
    assert total_mass(chain_of(EVERYTHING)) == pytest.approx(parts, rel=1e-14)


@pytest.mark.parametrize("link", [BOX, CYLINDER, SPHERE])
def test_every_link_has_its_solids_own_inertia(link: Data) -> None:
    chain = chain_of(manipulator(actuator(3, X, link=link)))
    for place in range(4):
        (shape,) = chain.links[place].shapes
        inertial = chain.links[place].inertial
        assert inertial.inertia == pytest.approx(shape.solid.inertia(inertial.mass), rel=1e-14)
        assert inertial.centre == shape.position


def test_rounding_weighs_nothing() -> None:
    plain = chain_of(manipulator(actuator(3, X, link=BOX)))
    rounded = chain_of(manipulator(actuator(3, X, link=STADIUM)))
    assert [link.inertial for link in plain.links] == [link.inertial for link in rounded.links]


def test_a_declared_inertia_is_used_as_declared() -> None:
    declared = [3e-7, 1e-8, 2e-8, 4e-7, 3e-8, 5e-7]
    link = {**BOX, "inertial_values": declared}
    chain = chain_of(manipulator(actuator(2, X, link=link), base_definition={**link, "mass": 0.01}))
    full = chain.links[1].inertial
    assert full.inertia == tuple(declared)
    half = solids.shortened_inertia(Box((0.023, 0.017, 0.02)), tuple(declared), 0.5)
    assert chain.links[2].inertial.inertia == pytest.approx(half, rel=1e-15)
    # base and first half link, lumped
    parts = [(0.01, 0.01, tuple(declared)), (0.0015, 0.025, half)]
    expected = solids.lumped(
        tuple(solids.Inertial(mass, (0.0, 0.0, at), inertia) for mass, at, inertia in parts)
    )
    assert chain.links[0].inertial == expected


def test_an_offset_moves_the_body_and_its_mass_and_not_the_backbone() -> None:
    plain = chain_of(manipulator(actuator(2, X)))
    offset = [0.001, 0.002, 0.003, 0.1, 0.2, 0.3]
    moved = chain_of(manipulator(actuator(2, X, link={**BOX, "origin_offset": offset})))
    assert moved.joints == plain.joints
    assert moved.tip == plain.tip
    turn = geometry.rotation_from_rpy((0.1, 0.2, 0.3))
    for one, other in zip(plain.links, moved.links, strict=True):
        centre = geometry.add(one.inertial.centre, (0.001, 0.002, 0.003))
        assert other.inertial.centre == pytest.approx(centre, abs=1e-17)
        assert other.shapes[0].rpy == (0.1, 0.2, 0.3)
        inertia = geometry.rotated_tensor(one.inertial.inertia, turn)
        assert other.inertial.inertia == pytest.approx(inertia, rel=1e-14)


def test_mujoco_finds_the_same_mass_and_centre() -> None:
    chain = chain_of(EVERYTHING)
    # MuJoCo welds the root to the world and forgets its mass, unless it can move
    text = render(chain).replace(
        '<link name="base">',
        '<link name="world"/><joint name="root" type="floating"><parent link="world"/>'
        '<child link="base"/></joint><link name="base">',
    )
    model = mujoco.MjModel.from_xml_string(text)
    state = mujoco.MjData(model)
    angles = bent(chain)
    state.qpos[7:] = angles
    mujoco.mj_forward(model, state)
    assert model.body_mass.sum() == pytest.approx(total_mass(chain), rel=1e-12)
    poses = kinematics.link_poses(chain, angles, Pose())
    weighted = [
        np.array(pose.point(link.inertial.centre)) * link.inertial.mass
        for pose, link in zip(poses, chain.links, strict=True)
    ]
    centre = sum(weighted) / total_mass(chain)
    assert np.allclose(state.subtree_com[0], centre, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    "data",
    [EVERYTHING, manipulator(actuator(6, X, Y, Z, link=CYLINDER), tip_definition=SPHERE)],
)
def test_mujoco_and_bullet_feel_the_same_inertia(data: Data) -> None:
    chain = chain_of(data)
    angles = bent(chain)
    model = mujoco_model(chain, (0, 0, 0), 1e-3)
    state = mujoco.MjData(model)
    state.qpos[:] = angles
    mujoco.mj_forward(model, state)
    by_mujoco = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, state, by_mujoco)
    by_bullet = bullet_mass_matrix(chain, angles)
    ours = mass_matrix(chain, angles)
    assert np.allclose(ours, by_mujoco, rtol=1e-9, atol=1e-9 * ours.max())
    assert np.allclose(ours, by_bullet, rtol=1e-9, atol=1e-9 * ours.max())


def mass_matrix(chain: Chain, angles: list[float]) -> np.ndarray:
    """Return the joint-space inertia from Jacobians: sum of Jᵀ m J + Jωᵀ I Jω over the links."""
    poses = kinematics.link_poses(chain, angles, Pose())
    count = len(chain.joints)
    axes = [
        np.array(geometry.rotate(pose.rotation, joint.axis))
        for pose, joint in zip(poses[1:], chain.joints, strict=True)
    ]
    total = np.zeros((count, count))
    for place, (link, pose) in enumerate(zip(chain.links, poses, strict=True)):
        centre = np.array(pose.point(link.inertial.centre))
        xx, xy, xz, yy, yz, zz = geometry.rotated_tensor(link.inertial.inertia, pose.rotation)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        linear, angular = np.zeros((3, count)), np.zeros((3, count))
        for joint in range(place):
            angular[:, joint] = axes[joint]
            arm = centre - np.array(poses[joint + 1].position)
            linear[:, joint] = np.cross(axes[joint], arm)
        total += link.inertial.mass * linear.T @ linear + angular.T @ inertia @ angular
    return total


# rounding


def rounding_of(link: Data, *axis: float) -> tuple[Shape, ...]:
    """Return the shapes that round the only hinge of an actuator."""
    offset = [0.001, 0.002, 0.003, 0, 0, 0]
    joint = hinge(*axis, neutral_axis_offset=offset)
    chain = chain_of(manipulator(actuator(1, joint, link=link)))
    body, *rounding = chain.links[0].shapes
    assert body.position == (0.0, 0.0, 0.005)
    assert len(chain.links[1].shapes) == 1
    hinge_at = chain.joints[0].origin
    assert hinge_at == pytest.approx((0.001, 0.002, 0.013))
    for shape in rounding:
        assert shape.position == hinge_at
    return tuple(rounding)


@pytest.mark.parametrize(
    ("axis", "solid"),
    [
        ((1, 0, 0), Cylinder(0.023, 0.0085)),
        ((-1, 0, 0), Cylinder(0.023, 0.0085)),
        ((5, 0, 0), Cylinder(0.023, 0.0085)),
        ((0, 1, 0), Cylinder(0.017, 0.0115)),
        ((0, -1, 0), Cylinder(0.017, 0.0115)),
    ],
)
def test_a_stadium_is_rounded_by_a_cylinder_along_the_hinge(
    axis: tuple[float, float, float], solid: Cylinder
) -> None:
    (shape,) = rounding_of(STADIUM, *axis)
    assert shape.solid == solid
    along = geometry.rotate(geometry.rotation_from_rpy(shape.rpy), (0.0, 0.0, 1.0))
    assert along == pytest.approx(geometry.unit(axis), abs=1e-15)


@pytest.mark.parametrize("axis", [(0.7, 0.7, 0), (1, -2, 0), (-1, 0.01, 0), (0.5, 0.3, 0.6)])
def test_askew_the_cylinder_fits_into_the_stadium(axis: tuple[float, float, float]) -> None:
    (shape,) = rounding_of(STADIUM, *axis)
    assert isinstance(shape.solid, Cylinder)
    along = geometry.rotate(geometry.rotation_from_rpy(shape.rpy), (0.0, 0.0, 1.0))
    ux, uy, _ = geometry.unit((axis[0], axis[1], 0.0))
    assert along == pytest.approx((ux, uy, 0.0), abs=1e-15)
    length, width = shape.solid.length, 2 * shape.solid.radius
    extent = (length * abs(ux) + width * abs(uy), length * abs(uy) + width * abs(ux))
    gaps = (0.023 - extent[0], 0.017 - extent[1])
    assert min(gaps) == pytest.approx(0, abs=1e-15)
    assert min(length, width) > 0.005


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, -1, 0), (0.7, 0.7, 0), (0.5, 0.3, 0.6)])
def test_a_capsule_is_rounded_by_a_sphere(axis: tuple[float, float, float]) -> None:
    (shape,) = rounding_of(CAPSULE, *axis)
    assert shape.solid == Sphere(0.01)


@pytest.mark.parametrize("link", [STADIUM, CAPSULE])
def test_a_joint_that_twists_opens_no_gap(link: Data) -> None:
    assert rounding_of(link, 0, 0, 1) == ()
    assert rounding_of(link, 0, 0, -2) == ()


@pytest.mark.parametrize("link", [BOX, CYLINDER])
def test_sharp_shapes_are_not_rounded(link: Data) -> None:
    assert rounding_of(link, 1, 0, 0) == ()


def test_a_fixed_joint_is_not_rounded() -> None:
    chain = chain_of(manipulator(actuator(2, X, FIXED, link=CAPSULE)))
    spheres = [
        shape for link in chain.links for shape in link.shapes if shape.solid == Sphere(0.01)
    ]
    assert len(spheres) == 1


def test_the_free_ends_of_a_capsule_base_and_tip_are_round() -> None:
    chain = chain_of(manipulator(actuator(1, X), base_definition=CAPSULE, tip_definition=CAPSULE))
    body, cap, _ = chain.links[0].shapes
    assert (body.solid, body.position) == (Cylinder(0.02, 0.01), (0.0, 0.0, 0.01))
    assert (cap.solid, cap.position) == (Sphere(0.01), (0.0, 0.0, 0.0))
    _, body, cap = chain.links[1].shapes
    assert body.solid == Cylinder(0.02, 0.01)
    assert cap.solid == Sphere(0.01)
    assert cap.position[2] - body.position[2] == pytest.approx(0.01)


def test_the_free_ends_of_a_stadium_base_and_tip_are_round() -> None:
    turned = {**STADIUM, "origin_offset": [0, 0, 0, 0, math.pi / 2, 0]}
    chain = chain_of(manipulator(actuator(1, Y), base_definition=STADIUM, tip_definition=turned))
    body, cap, _ = chain.links[0].shapes
    assert body.solid == Box((0.023, 0.017, 0.02))
    assert (cap.solid, cap.position) == (Cylinder(0.023, 0.0085), (0.0, 0.0, 0.0))
    along = geometry.rotate(geometry.rotation_from_rpy(cap.rpy), (0.0, 0.0, 1.0))
    assert along == pytest.approx((1.0, 0.0, 0.0), abs=1e-15)
    # turned by a quarter, the tip's own z axis points along x and its x axis down
    _, body, cap = chain.links[1].shapes
    assert geometry.subtract(cap.position, body.position) == pytest.approx(
        (0.01, 0.0, 0.0), abs=1e-15
    )
    along = geometry.rotate(geometry.rotation_from_rpy(cap.rpy), (0.0, 0.0, 1.0))
    assert along == pytest.approx((0.0, 0.0, -1.0), abs=1e-15)
