"""Poses of many instants at once: those of each alone, to the last bit."""

from __future__ import annotations

import json

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.simulation.dynamics.forward_kinematics import (
    ForwardKinematics,
    frames_from_poses,
    point_positions,
    quaternions,
)
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import EVERYTHING
from tests.builders.scenes import scene_from_file, scene_from_text

INSTANTS = 37


def chain_of_scene(name: str) -> Chain:
    if name == "everything":
        text = json.dumps({"manipulators": [{"definition": EVERYTHING}]})
        return make_plan(scene_from_text(text)).bodies[0].chain
    return make_plan(scene_from_file(name)).bodies[0].chain


@pytest.fixture(params=["everything", "scene.yaml", "starfish_scene.yaml"])
def chain(request: pytest.FixtureRequest) -> Chain:
    return chain_of_scene(request.param)


def angles_of(chain: Chain) -> np.ndarray:
    return np.random.default_rng(2).uniform(-3, 3, (len(chain.joints), INSTANTS))


def bases(count: int) -> list[Pose]:
    random = np.random.default_rng(4)
    poses = []
    for x, y, z, roll, pitch, yaw in random.uniform(-1, 1, (count, 6)).tolist():
        poses.append(Pose.of((x, y, z), (roll, pitch, yaw)))
    return poses


@pytest.mark.parametrize("count", [1, INSTANTS])
def test_frames_are_those_of_one_pose_at_a_time(chain: Chain, count: int) -> None:
    angles, at = angles_of(chain), bases(count)
    positions, rotations = ForwardKinematics(chain).frames(angles, frames_from_poses(at))
    turns = quaternions(rotations)
    for instant in range(INSTANTS):
        poses = link_poses(chain, angles[:, instant].tolist(), at[instant % count])
        for link, pose in enumerate(poses):
            place, axes = positions[link, :, instant], rotations[link, :, :, instant]
            assert place == pytest.approx(pose.position, abs=1e-12)
            assert axes == pytest.approx(np.array(pose.rotation), abs=1e-13)
            turn = geometry.quaternion_from_rotation(pose.rotation)
            assert turns[link, :, instant] == pytest.approx(turn, abs=1e-12)
        ends = point_positions((positions, rotations), -1, (0.1, -0.2, 0.3))
        assert ends[:, instant] == pytest.approx(poses[-1].point((0.1, -0.2, 0.3)), abs=1e-12)


def test_no_frame_depends_on_which_others_are_asked_for(chain: Chain) -> None:
    angles, at = angles_of(chain), bases(INSTANTS)
    poses = ForwardKinematics(chain)

    def reported(some: slice) -> list[np.ndarray]:
        positions, rotations = poses.frames(angles[:, some], frames_from_poses(at[some]))
        return [positions, rotations, quaternions(rotations)]

    whole = reported(slice(None))
    for first, last in ((0, 1), (1, 2), (3, 11), (5, 36), (30, INSTANTS)):
        for part, all_of_them in zip(reported(slice(first, last)), whole, strict=True):
            assert part.tolist() == all_of_them[..., first:last].tolist()
