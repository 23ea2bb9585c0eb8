"""The pinch grasp in short: what is read from a run, what is held, and that steps do not matter."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.solids import Box
from somo_cli.simulation.run import RunSummary
from tests.builders.scenes import scene_from_file
from tests.studies import pinch
from tests.studies.pinch import Grasp, grasp, map_table, setting, spread
from tests.studies.running import Record, recorded


def test_a_setting_moves_both_fingers_and_keeps_their_length() -> None:
    one = setting(0.08, 0.15, distal=6, scale=10)
    scene = scene_from_file(one.scene, *one.sets)
    assert scene.scale == Scale(10)
    (block,) = scene.objects
    assert block.chain.links[0].shapes[0].solid == Box((0.06, 0.08, 0.06))
    for finger in scene.manipulators:
        assert finger.position[2] == pytest.approx(0.15 + pinch.DESCENT)
        chain = finger.compiled.chain
        assert chain.length == pytest.approx(0.11)
        assert sum(joint.actuator == 1 for joint in chain.joints) == 6


def test_what_a_grasp_is_read_from() -> None:
    times = np.array([0, 1.4, 1.5, 3])
    columns = {
        "time_s": times,
        "block.pose.z_m": np.array([0.03, 0.03, 0.03, 0.09]),
        "block.pose.qw": np.array([1, 1, 1, math.cos(0.1)]),
        "left.contact.normal_n": np.array([0, 0.3, 0.4, 0.5]),
    }
    found = grasp(Record(columns, RunSummary(3000, 4, 1.0)))
    assert found.is_lifted
    assert (found.rise, found.grip, found.hold) == (pytest.approx(0.06), 0.4, 0.5)
    assert found.tilt == pytest.approx(0.2)
    assert not Grasp(0.0399, 1, 1, 0).is_lifted


def test_the_map_has_a_line_for_each_height() -> None:
    places = [(height, width) for height in pinch.HEIGHTS for width in pinch.WIDTHS]
    lines = list(map_table({place: Grasp(0.1 * place[0], 1, 1, 0) for place in places}))
    assert len(lines) == 2 + len(pinch.HEIGHTS)
    assert lines[2].split() == ["130", *["13.0"] * len(pinch.WIDTHS)]


def test_spread_is_the_largest_distance_from_the_first() -> None:
    assert spread([2.0, 2.1, 1.8]) == pytest.approx(0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("width", "height", "is_lifted"),
    [(0.01, 0.15, True), (0.06, 0.16, True), (0.06, 0.19, False), (0.12, 0.16, False)],
)
def test_which_blocks_are_lifted(width: float, height: float, is_lifted: bool) -> None:
    pytest.importorskip("pybullet")
    assert grasp(recorded(setting(width, height))).is_lifted is is_lifted


@pytest.mark.slow
@pytest.mark.parametrize(("width", "height"), [(0.02, 0.15), (0.06, 0.16)])
def test_a_block_held_by_its_faces_feels_neither_step_nor_scale(
    width: float, height: float
) -> None:
    pytest.importorskip("pybullet")
    grasps = [
        grasp(recorded(setting(width, height, step=step, scale=scale)))
        for step, scale in pinch.VARIANTS
    ]
    assert all(one.is_lifted for one in grasps)
    assert spread([one.grip for one in grasps]) < 5e-3
    assert spread([one.hold for one in grasps]) < 1e-3
    assert spread([one.rise for one in grasps]) < 1e-4
    # the whole weight hangs on the friction of both fingers: the grip is no less than half of it
    assert min(one.hold for one in grasps) > 0.5 * 0.02 * 9.81
