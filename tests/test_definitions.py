"""What we ship in definitions/: the numbers are what the comments beside them say, and it runs."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg

from somo_cli.loading import load
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import compile_definition
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.manipulator.round_solids import RoundedBox
from tests.builders.command import Somo
from tests.builders.urdf_in_bullet import bullet_mass_matrix

FOLDER = Path(__file__).parents[1] / "definitions"
FILES = sorted(FOLDER.glob("*.yaml"))
SCENES = [path.stem for path in FILES if path.stem.endswith("scene")]


@cache
def chain_of_file(name: str) -> Chain:
    return compile_definition(load(str(FOLDER / f"{name}.yaml"))).chain


def heights_below_the_tip(chain: Chain) -> list[float]:
    poses = link_poses(chain, [0.0] * len(chain.joints), Pose())
    return [chain.length - pose.position[2] for pose in poses[1:]]


def modes(chain: Chain, axis: int) -> list[tuple[float, float]]:
    """Return frequency [rad/s] and damping ratio of the modes about an axis, slowest first."""
    mass = bullet_mass_matrix(chain, [0.0] * len(chain.joints))
    stiffness = np.diag([joint.stiffness for joint in chain.joints])
    damping = np.diag([joint.damping for joint in chain.joints])
    squares, shapes = scipy.linalg.eigh(stiffness, mass)
    found = []
    for frequency, shape in zip(np.sqrt(squares), shapes.T, strict=True):
        energy = shape**2 * np.diag(stiffness)
        about = sum(
            e for e, joint in zip(energy, chain.joints, strict=True) if joint.axis[axis] == 1
        )
        if about > 0.5 * energy.sum():
            ratio = shape @ damping @ shape / (2 * frequency)  # shapes have unit modal mass
            found.append((float(frequency), float(ratio)))
    return found


@pytest.mark.parametrize(("axis", "stiffness"), [(0, 6.12), (1, 29.05)])
def test_the_tip_of_the_finger_is_as_stiff_as_measured(axis: int, stiffness: float) -> None:
    chain = chain_of_file("finger")
    compliance = sum(
        arm**2 / joint.stiffness
        for arm, joint in zip(heights_below_the_tip(chain), chain.joints, strict=True)
        if joint.axis[axis] == 1
    )
    assert 1 / compliance == pytest.approx(stiffness, rel=1e-9)


@pytest.mark.parametrize(
    ("actuator", "axis", "stiffness"), [(0, 0, 78), (0, 1, 156), (1, 0, 58), (1, 1, 116)]
)
def test_each_segment_of_the_finger_of_two_is_as_stiff_as_said(
    actuator: int, axis: int, stiffness: float
) -> None:
    chain = chain_of_file("two_segment_finger")
    end = 0.01 + 0.05 * (1 + actuator)  # m: above the base frame
    poses = link_poses(chain, [0.0] * len(chain.joints), Pose())
    compliance = sum(
        (end - pose.position[2]) ** 2 / joint.stiffness
        for pose, joint in zip(poses[1:], chain.joints, strict=True)
        if joint.actuator == actuator and joint.axis[axis] == 1
    )
    assert 1 / compliance == pytest.approx(stiffness, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "axis", "frequency", "ratio"),
    [
        ("finger", 0, 15.66, 0.030),
        ("finger", 1, 34.40, 0.030),
        ("planar_finger", 0, 22.8, 0.029),
        ("three_axis_finger", 0, 33.7, 0.030),
        ("three_axis_finger", 1, 98.6, 0.030),
        ("three_axis_finger", 2, 734, 0.030),
        ("two_segment_finger", 0, 22.3, 0.089),
        ("two_segment_finger", 1, 29.5, 0.118),
        ("arm", 0, 1.53, 0.031),
        ("ball_arm", 0, 1.06, 0.531),
        ("cantilever", 1, 6.43, 0.643),
        ("planar_arm", 0, 4.38, 0.110),
    ],
)
def test_the_lowest_modes_and_their_damping(
    name: str, axis: int, frequency: float, ratio: float
) -> None:
    found = modes(chain_of_file(name), axis)[0]
    assert found == (pytest.approx(frequency, rel=3e-3), pytest.approx(ratio, abs=1e-3))


@pytest.mark.parametrize(
    ("name", "area", "second_moment", "segment"),
    [
        ("arm", 0.04**2, 0.04**4 / 12, 0.015),
        ("snake", math.pi * 0.02**2, math.pi * 0.02**4 / 4, 0.025),
    ],
)
def test_arm_and_snake_are_soft_silicone(
    name: str, area: float, second_moment: float, segment: float
) -> None:
    chain = chain_of_file(name)
    assert chain.links[1].inertial.mass == pytest.approx(1070 * area * segment, rel=1e-3)
    for joint in chain.joints:
        # two axes take turns, so a joint stands for two segments
        assert joint.span == pytest.approx(2 * segment)
        assert joint.stiffness == pytest.approx(0.5e6 * second_moment / joint.span, rel=1e-4)


@pytest.mark.moderate
def test_shipped_files_have_no_problems(somo: Somo) -> None:
    done = somo("check", *FILES, *sorted((FOLDER / "trajectories").glob("*.yaml")))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("seed", ["0", "1"])
def test_the_same_urdf_in_any_process(somo: Somo, seed: str) -> None:
    done = somo("build", FOLDER / "arm.yaml", "-o", "-", env={"PYTHONHASHSEED": seed})
    golden = Path(__file__).parent / "golden" / "arm.urdf"
    assert (done.returncode, done.stdout) == (0, golden.read_text("utf-8"))


def recorded(somo: Somo, scene: str, steps: int, folder: Path) -> dict[str, np.ndarray]:
    """Run a scene, and return its columns."""
    pytest.importorskip("pybullet")
    path = folder / f"{scene}.csv"
    done = somo("run", FOLDER / f"{scene}.yaml", "--steps", str(steps), "-o", path, "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    with path.open(newline="", encoding="utf-8") as stream:
        names, *rows = csv.reader(stream)
    return dict(zip(names, np.array(rows, float).T, strict=True))


def columns(table: dict[str, np.ndarray], *endings: str) -> np.ndarray:
    """Return the columns whose names end so, one row per row of the table."""
    return np.transpose([table[name] for name in table if name.endswith(endings)])


def first_chain_in(scene: str) -> Chain:
    """Return the chain of the first manipulator of a scene."""
    text = (FOLDER / f"{scene}.yaml").read_text("utf-8")
    found = re.search(r"definition: (\w+)\.yaml", text)
    assert found is not None
    return chain_of_file(found[1])


@pytest.mark.moderate
@pytest.mark.parametrize("scene", SCENES)
def test_every_scene_moves_and_stays_in_bounds(somo: Somo, scene: str, tmp_path: Path) -> None:
    table = recorded(somo, scene, 2000, tmp_path)
    assert table["time_s"][-1] == pytest.approx(2.0)
    chain = first_chain_in(scene)
    reaches = []
    for limb in chain.backbones:
        end = f"{limb.prefix}tip."
        tip = columns(table, f".{end}x_m", f".{end}y_m", f".{end}z_m")
        reaches.append(np.linalg.norm(tip - tip[0], axis=1).max() / chain.length)
    # not every arm of one that leans on its feet slides in the first two seconds
    least = {"blocked_force_scene": 0.04, "starfish_shift_scene": 0.08}.get(scene, 0.09)
    assert (max if scene == "starfish_shift_scene" else min)(reaches) > least
    assert max(reaches) < 1.5
    assert np.abs(columns(table, ".angle_rad")).max() < 1.0


@pytest.mark.moderate
def test_the_finger_does_not_reach_the_table_it_stands_on(somo: Somo, tmp_path: Path) -> None:
    table = recorded(somo, "scene", 2000, tmp_path)
    # the tip is a ball with its centre 5 mm beyond the end of the backbone
    assert table["finger.tip.z_m"].min() > 0.02


@pytest.mark.moderate
def test_the_bar_turns_and_the_run_ends_at_rest(somo: Somo, tmp_path: Path) -> None:
    table = recorded(somo, "turn_scene", 20000, tmp_path)
    assert table["bar.angles.z_rad"][-1] == pytest.approx(0.21, abs=0.02)
    meta = json.loads((tmp_path / "turn_scene.meta.json").read_text("utf-8"))
    assert meta["stopped_by"] == {"stop": 0, "reason": "all has been at rest for 0.3 s"}
    assert meta["steps"] < 12000
    events = (tmp_path / "turn_scene.events.csv").read_text("utf-8").splitlines()
    kinds = [line.split(",")[1:6:2] for line in events]
    assert kinds == [
        ["event", "first_link", "second_link"],
        ["begin", "object", "ground"],
        ["begin", "actuator_0_segment_10", "object"],
        ["end", "actuator_0_segment_10", "object"],
    ]


@pytest.mark.moderate
def test_what_tumbles_comes_to_rest_at_its_true_height(somo: Somo, tmp_path: Path) -> None:
    table = recorded(somo, "tumble_scene", 2000, tmp_path)
    assert table["die.pose.z_m"][-1] == pytest.approx(0.015, abs=2e-6)
    # on its foot, whose outer edge is the origin of its frame
    assert table["angle.pose.z_m"][-1] == pytest.approx(0, abs=2e-6)
    assert table["pill.pose.z_m"] == pytest.approx(0.015, abs=2e-5)
    assert table["pill.pose.y_m"][-1] > 0.1
    die = RoundedBox((0.03, 0.03, 0.03), 0.004).volume
    weights = {"die": 600 * die, "angle": 2700 * (30 * 30 * 5 + 5 * 30 * 25) * 1e-9}
    for name, mass in weights.items():
        assert table[f"{name}.contact.fz_n"][-1] == pytest.approx(9.81 * mass, rel=1e-3)


@pytest.mark.moderate
def test_the_snake_stays_on_the_spot_and_in_its_plane(somo: Somo, tmp_path: Path) -> None:
    table = recorded(somo, "snake_scene", 1000, tmp_path)
    chain = chain_of_file("snake")
    angles = columns(table, ".angle_rad")
    bases = columns(table, "base_pose.x_m", "base_pose.y_m", "base_pose.z_m")
    turns = columns(table, ".qx", ".qy", ".qz", ".qw")
    centres = []
    for base, turn, angle in zip(bases, turns, angles, strict=True):
        pose = Pose(tuple(base), geometry.rotation_from_quaternion(tuple(turn)))
        centres.append(centre_of_chain(chain, angle, pose))
    # the engine keeps momentum to second order in the time step: 0.2 mm here, a quarter at half
    assert np.abs(centres).max() < 5e-4
    assert np.abs(columns(table, ".tip.z_m")).max() < 1e-6


@pytest.mark.moderate
def test_the_starfish_stands_on_its_arms(somo: Somo, tmp_path: Path) -> None:
    table = recorded(somo, "starfish_scene", 2000, tmp_path)
    raised = columns(table, "base_pose.z_m")[50:]
    assert raised.min() > 0.01
    # the backbone's end is the centre of a ball with a radius of 15 mm, which leaves the ground
    # and dips into it no deeper than half a millimetre
    heights = columns(table, "_tip.z_m")
    assert heights.shape == (201, 5)
    assert heights.min() > 0.0145


def centre_of_chain(chain: Chain, angles: Sequence[float], base: Pose) -> np.ndarray:
    pairs = zip(link_poses(chain, angles, base), chain.links, strict=True)
    weighted = [
        np.array(pose.point(link.inertial.centre)) * link.inertial.mass for pose, link in pairs
    ]
    return np.sum(weighted, axis=0) / sum(link.inertial.mass for link in chain.links)


@pytest.mark.slow
def test_the_crawler_crawls_and_stays_on_the_ground(somo: Somo, tmp_path: Path) -> None:
    table = recorded(somo, "crawler_scene", 1000, tmp_path)
    middle = (
        columns(table, "base_pose.x_m", "base_pose.y_m") + columns(table, ".tip.x_m", ".tip.y_m")
    ) / 2
    # ahead is where the base points, against the wave
    assert middle[-1, 0] - middle[0, 0] < -0.1
    assert np.abs(table["crawler.base_pose.z_m"] - 0.015).max() < 1e-4
