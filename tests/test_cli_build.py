"""somo build for other programs: formats, scales, what it says, and what it refuses."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.builders.command import Somo

DEFINITIONS = Path(__file__).parents[1] / "definitions"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("finger.yaml", "scene.yaml", "cantilever.yaml"):
        shutil.copy(DEFINITIONS / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("options", "written", "start", "said"),
    [
        (("--for", "pybullet"), "finger.urdf", "<robot", "world scale 20: 20 times its size"),
        (("--for", "isaac"), "finger.urdf", "<robot", "world scale 1\n"),
        (("--for", "drake"), "finger.sdf", "<sdf", "world scale 1: SI\n"),
        (("--format", "mjcf"), "finger.xml", "<mujoco", "world scale 1: SI\n"),
    ],
)
def test_a_program_chooses_format_and_scale(
    somo: Somo, here: Path, options: tuple[str, str], written: str, start: str, said: str
) -> None:
    ended = somo("build", "finger.yaml", *options)
    assert (ended.returncode, ended.stdout) == (0, "")
    assert said in ended.stderr
    text = (here / written).read_text("utf-8")
    assert start in text
    assert ("World scale 20, for PyBullet" in text) == ("pybullet" in options)
    piped = somo("build", "finger.yaml", *options, "-o", "-")
    assert (piped.returncode, piped.stdout, piped.stderr) == (0, text, "")


def test_isaac_gets_limits_of_continuous_joints(somo: Somo, here: Path) -> None:
    ended = somo("build", "cantilever.yaml", "--for", "isaac", "-o", "-")
    assert ended.stdout.count('<limit effort="1000000" velocity="1000000" />') == 10


def test_a_scene_becomes_mjcf_and_says_what_is_missing(somo: Somo, here: Path) -> None:
    ended = somo("build", "scene.yaml", "--for", "mujoco")
    assert (ended.returncode, ended.stdout) == (0, "")
    assert ended.stderr == (
        "scene.xml: manipulators: 1, joints: 10, objects: 0, SI, time step 0.0005 s, "
        "not 0.001: the springs of MuJoCo need it\n"
        "  not in it: torques over time: the controls are those at the start\n"
    )
    assert "<mujoco" in (here / "scene.xml").read_text("utf-8")


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("finger.yaml", "--format", "usd"), "'usd' is not one of urdf, sdf, mjcf"),
        (("finger.yaml", "--for", "blender"), "'blender' is not one of pybullet"),
        (("finger.yaml", "--for", "drake", "--format", "mjcf"), "drake takes sdf, not mjcf"),
        (("finger.yaml", "--for", "mujoco", "--scale", "20"), "takes SI, a scale of 1"),
        (("finger.yaml", "--format", "sdf", "--verify"), "it reads a URDF back"),
        (("finger.yaml", "--free-base"), "a URDF does not say what holds it"),
        (("scene.yaml", "--for", "drake"), "only mjcf takes a whole scene"),
        (("scene.yaml", "--for", "mujoco", "--tip-frame", "tool"), "a scene has sites"),
        (("scene.yaml", "--for", "mujoco", "-o", "finger.yaml"), "one of the files that are read"),
    ],
)
def test_what_does_not_go_together_is_a_usage_error(
    somo: Somo, here: Path, arguments: tuple[str, ...], said: str
) -> None:
    before = {path.name: path.read_bytes() for path in here.iterdir()}
    ended = somo("build", *arguments)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert said in " ".join(ended.stderr.split())
    assert {path.name: path.read_bytes() for path in here.iterdir()} == before
