"""Against SoMo's own generator: our kinematics, and two other programs that read our URDF."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yourdfpy

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain, Shape
from somo_cli.manipulator.compile import compile_definition
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.manipulator.solids import Cylinder
from somo_cli.manipulator.urdf import render
from tests.builders.definitions import (
    EVERYTHING,
    Data,
    X,
    actuator,
    bent,
    chain_of,
    document_of,
    manipulator,
)
from tests.builders.urdf_in_bullet import in_bullet

SOMO = json.loads(Path(__file__).with_name("somo_kinematics.json").read_text("utf-8"))
NAMES = ["ihm_finger", "stadium_three_axes", "planar_varying_stiffness"]

# (chain, angles) -> position and rotation of every link frame, root first
Frames = Callable[[Chain, Sequence[float]], list[tuple[np.ndarray, np.ndarray]]]


def frames_of_ours(chain: Chain, angles: Sequence[float]) -> list[tuple[np.ndarray, np.ndarray]]:
    poses = link_poses(chain, angles, Pose())
    return [(np.array(pose.position), np.array(pose.rotation)) for pose in poses]


def frames_of_yourdfpy(
    chain: Chain, angles: Sequence[float]
) -> list[tuple[np.ndarray, np.ndarray]]:
    robot = yourdfpy.URDF.load(io.BytesIO(render(chain).encode()), load_meshes=False)
    robot.update_cfg({joint.name: q for joint, q in zip(chain.joints, angles, strict=True)})
    matrices = [robot.get_transform(link.name, chain.links[0].name) for link in chain.links]
    return [(matrix[:3, 3], matrix[:3, :3]) for matrix in matrices]


def frames_of_bullet(chain: Chain, angles: Sequence[float]) -> list[tuple[np.ndarray, np.ndarray]]:
    with in_bullet(render(chain)) as (bullet, client, body):
        for joint, angle in enumerate(angles):
            bullet.resetJointState(body, joint, angle, physicsClientId=client)
        found = [(np.zeros(3), np.eye(3))]
        for joint in range(len(chain.joints)):
            state = bullet.getLinkState(
                body, joint, computeForwardKinematics=True, physicsClientId=client
            )
            rotation = np.reshape(bullet.getMatrixFromQuaternion(state[5]), (3, 3))
            found.append((np.array(state[4]), rotation))
    return found


# the engine returns frames in single precision
READERS = [(frames_of_ours, 1e-9), (frames_of_yourdfpy, 1e-9), (frames_of_bullet, 1e-6)]


def chain_of_somo(name: str) -> Chain:
    return compile_definition(document_of(SOMO[name]["definition"])).chain


def angles_of(chain: Chain, pose: str) -> list[float]:
    if pose == "at_zero":
        return [0.0] * len(chain.joints)
    return [-0.05 if place % 2 else 0.1 for place in range(len(chain.joints))]


def main_shapes(chain: Chain, definition: Data) -> list[tuple[int, Shape]]:
    """Return base, segments and tips with the number of their link; without rounding."""
    is_stadium = definition["actuator_definitions"][0]["link_definition"]["shape_type"] == "stadium"
    return [
        (place, shape)
        for place, link in enumerate(chain.links)
        for shape in link.shapes
        if not (is_stadium and isinstance(shape.solid, Cylinder))
    ]


@pytest.mark.parametrize("name", NAMES)
def test_axes_and_number_of_moving_joints(name: str) -> None:
    chain = chain_of_somo(name)
    assert [list(joint.axis) for joint in chain.joints] == SOMO[name]["joint_axes"]


@pytest.mark.parametrize("name", NAMES)
def test_the_mass_is_somos_less_two_half_links(name: str) -> None:
    # SoMo's half links weigh as much as whole ones
    mass = sum(link.inertial.mass for link in chain_of_somo(name).links)
    link = SOMO[name]["definition"]["actuator_definitions"][0]["link_definition"]
    assert mass == pytest.approx(SOMO[name]["total_mass"] - link["mass"], rel=1e-12)


@pytest.mark.parametrize(("frames", "tolerance"), READERS)
@pytest.mark.parametrize("pose", ["at_zero", "bent"])
@pytest.mark.parametrize("name", NAMES)
def test_joint_frames_are_somos(name: str, pose: str, frames: Frames, tolerance: float) -> None:
    chain = chain_of_somo(name)
    found = frames(chain, angles_of(chain, pose))
    expected = SOMO[name][f"joint_frames_{pose}"]
    assert len(found) == len(expected) + 1
    for joint, (position, rotation), somo in zip(chain.joints, found[1:], expected, strict=True):
        assert np.allclose(position, somo["origin"], rtol=0, atol=tolerance)
        assert np.allclose(rotation @ joint.axis, somo["axis_world"], rtol=0, atol=tolerance)


@pytest.mark.parametrize(("frames", "tolerance"), READERS)
@pytest.mark.parametrize("pose", ["at_zero", "bent"])
@pytest.mark.parametrize("name", NAMES)
def test_bodies_are_where_somos_are(name: str, pose: str, frames: Frames, tolerance: float) -> None:
    chain = chain_of_somo(name)
    found = frames(chain, angles_of(chain, pose))
    centres = [
        found[place][0] + found[place][1] @ shape.position
        for place, shape in main_shapes(chain, SOMO[name]["definition"])
    ]
    expected = SOMO[name][f"link_centres_{pose}"]
    assert len(centres) == len(expected)
    assert np.allclose(centres, expected, rtol=0, atol=tolerance)


@pytest.mark.parametrize(("frames", "tolerance"), READERS[1:])
def test_everything_at_once_moves_alike(frames: Frames, tolerance: float) -> None:
    chain = chain_of(EVERYTHING)
    pairs = zip(frames(chain, bent(chain)), frames_of_ours(chain, bent(chain)), strict=True)
    for (position, rotation), (our_position, our_rotation) in pairs:
        assert np.allclose(position, our_position, rtol=0, atol=tolerance * chain.length)
        assert np.allclose(rotation, our_rotation, rtol=0, atol=tolerance)


def test_the_pose_of_the_base_carries_along() -> None:
    chain = chain_of(EVERYTHING)
    base = Pose.of((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    for here, there in zip(
        link_poses(chain, bent(chain), Pose()), link_poses(chain, bent(chain), base), strict=True
    ):
        assert there.position == pytest.approx(base.point(here.position), rel=1e-14)
        expected: Any = geometry.multiply(base.rotation, here.rotation)
        assert np.allclose(there.rotation, expected, atol=1e-15)


def test_equal_bends_lie_on_a_circle() -> None:
    chain = chain_of(manipulator(actuator(8, X)))
    poses = link_poses(chain, [0.1] * 8, Pose())
    # each segment turns by 0.1 rad; its hinges are corners of a regular polygon
    radius = 0.02 / (2 * math.tan(0.05))
    for pose in poses[1:]:
        y, z = pose.position[1] + radius, pose.position[2]
        assert math.hypot(y, z) == pytest.approx(math.hypot(radius, 0.01), rel=1e-12)
    assert poses[-1].point(chain.tip) == pytest.approx(
        (0.0, radius * (math.cos(0.8) - 1), radius * math.sin(0.8)), abs=1e-15
    )


@pytest.mark.parametrize("count", [0, 7, 9])
def test_one_angle_per_joint(count: int) -> None:
    with pytest.raises(ValueError, match="zip"):
        link_poses(chain_of(manipulator(actuator(8, X))), [0.0] * count, Pose())
