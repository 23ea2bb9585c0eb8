"""somo new: every kind passes all checks, runs, and does what its comments say."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import somo_cli
from somo_cli.templates.sizes import FINGER, Sizes
from tests.builders.command import Somo

pytest.importorskip("pybullet")


@pytest.fixture
def started(somo: Somo, tmp_path: Path) -> Path:
    """Return a folder with one of each kind, made by the command."""
    for kind in ("finger", "gripper", "arm", "snake"):
        ended = somo("new", kind, f"my_{kind}")
        assert ended.returncode == 0, ended.stderr
        assert ended.stderr == f"next: somo run my_{kind}_scene.yaml\n"
    assert somo("new", "scene", "stand", "--of", "my_arm.yaml").stdout == "stand.yaml\n"
    ended = somo("new", "study", "vary", "--of", "stand.yaml")
    assert (ended.stdout, ended.stderr) == ("vary.yaml\n", "next: somo sweep vary.yaml\n")
    return tmp_path


@pytest.mark.slow
def test_all_pass_every_check_and_the_gripper_lifts_its_ball(started: Path, somo: Somo) -> None:
    files = sorted(path.name for path in started.glob("*.yaml"))
    assert len(files) == 10
    checked = somo("check", "--strict", *files)
    assert (checked.returncode, checked.stderr) == (0, "")
    for scene in ("my_finger_scene", "my_arm_scene", "my_snake_scene", "stand"):
        assert somo("run", f"{scene}.yaml", "--duration", "0.02", "--strict").returncode == 0
    result = somo_cli.simulate(started / "my_gripper_scene.yaml")
    assert result.metadata["findings"] == []
    height = result["ball.pose.z_m"]
    assert height[-1] - height[0] == pytest.approx(0.05, abs=3e-3)  # by which the bases move
    weight = 0.05 * 9.81
    friction = 3 * result["finger_0.contact.normal_n"][-1]  # its coefficient is 1
    assert friction > 1.5 * weight
    swept = somo("sweep", "vary.yaml", "-j", "1", "-q")
    assert swept.returncode == 0, swept.stderr


def test_sizes_change_what_is_written(somo: Somo, tmp_path: Path) -> None:
    somo("new", "finger", "long", "--length", "0.2", "--modulus", "1e6", "--segments", "20")
    shown = somo("show", "long.yaml").stdout
    long = Sizes(0.2, 0.023, 0.017, 20, 1e6, 1070.0)
    assert "20 joints over 0.2 m" in shown
    assert f"each {long.stiffness('x'):.4g} N·m/rad" in shown


def test_the_stiffness_is_that_of_a_beam() -> None:
    bending = FINGER.modulus * FINGER.width * FINGER.depth**3 / 12
    in_series = FINGER.stiffness("x") / (FINGER.segments / 2)
    assert in_series == pytest.approx(bending / FINGER.length)
    assert FINGER.torque(0.8) == pytest.approx(0.8 * bending / FINGER.length)


def test_a_damping_ratio_is_met_by_the_lowest_mode() -> None:
    line = FINGER.density * FINGER.width * FINGER.depth
    frequency = 1.875104**2 * math.sqrt(FINGER.modulus * FINGER.second_moment("x") / line)
    frequency /= FINGER.length**2
    ratio = FINGER.damping("x") / FINGER.stiffness("x") * frequency / 2
    assert ratio == pytest.approx(0.05, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("fist", "a"), "'fist' is not one of finger, gripper, arm, snake, scene, study"),
        (("finger", "a b"), "'a b' is not a name"),
        (("finger", "fün"), "'fün' is not a name"),
        (("finger", "1st"), "'1st' is not a name: letters, digits and _, a letter first"),
        (("finger", "a", "--segments", "7"), "7 is not a multiple of 2"),
        (("finger", "a", "--length", "-1"), "-1 is not from 1e-6 to 1e15"),
        (("finger", "a", "--of", "b.yaml"), "it is not for a finger, which brings its own files"),
        (("scene", "a"), "give the definition that stands in the scene"),
        (("scene", "a", "--of", "b.yaml", "--length", "1"), "it is not for a scene"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_written(
    somo: Somo, tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    ended = somo("new", *arguments)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert message in " ".join(ended.stderr.split())
    assert not list(tmp_path.iterdir())


def test_what_is_there_stays_unless_forced(somo: Somo, tmp_path: Path) -> None:
    (tmp_path / "a_scene.yaml").write_text("mine")
    ended = somo("new", "finger", "a")
    assert ended.returncode == 2
    assert "a_scene.yaml is there: --force replaces it" in " ".join(ended.stderr.split())
    assert [path.name for path in tmp_path.iterdir()] == ["a_scene.yaml"]
    assert somo("new", "finger", "a", "--force").returncode == 0
    assert (tmp_path / "a_scene.yaml").read_text() != "mine"
