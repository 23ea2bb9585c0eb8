"""somo build for other programs, and somo import: what they write, say and refuse."""

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


def test_a_model_comes_back_as_a_definition(somo: Somo, here: Path) -> None:
    assert somo("build", "finger.yaml", "--for", "mujoco", "-o", "arm.xml").returncode == 0
    ended = somo("import", "arm.xml")
    assert (ended.returncode, ended.stdout) == (0, "")
    assert ended.stderr == (
        "arm.yaml: 11 links, 10 joints, 0.6444 kg, 0.11 m long, world scale 1\n"
    )
    text = (here / "arm.yaml").read_text("utf-8")
    assert text.startswith("# Imported from arm.xml; its format does not have torque per pressure")
    assert "spring_stiffness: 0.117045" in text
    piped = somo("import", "arm.xml", "-o", "-")
    assert (piped.returncode, piped.stdout, piped.stderr) == (0, text, "")
    again = somo("build", "arm.yaml", "--for", "mujoco", "-o", "-").stdout
    assert again == (here / "arm.xml").read_text("utf-8")


@pytest.mark.moderate
def test_an_import_replaces_no_file_unasked(somo: Somo, here: Path) -> None:
    assert somo("build", "finger.yaml", "-o", "finger.urdf").returncode == 0
    before = {path.name: path.read_bytes() for path in here.iterdir()}
    for arguments in (("finger.urdf",), ("finger.urdf", "-o", "finger.urdf")):
        ended = somo("import", *arguments)
        assert (ended.returncode, ended.stdout) == (2, "")
    (here / "broken.xml").write_text("<mujoco><worldbody/></mujoco>")
    ended = somo("import", "broken.xml")
    assert ended.returncode == 3
    assert ended.stderr.startswith("broken.xml:1:1: error: the world has 0 bodies with hinges\n")
    (here / "broken.xml").unlink()
    assert {path.name: path.read_bytes() for path in here.iterdir()} == before
