"""Every command, given an assembly."""

from __future__ import annotations

import csv
import json
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from tests.builders.command import Somo

FOLDER = Path(__file__).parents[1] / "definitions"
PAIR = """
assembly_name: pair
body_definition: {shape_type: box, dimensions: [0.12, 0.08, 0.02], mass: 0.3}
limbs:
  - {name: left, definition: finger.yaml, position: [-0.04, 0, 0.02]}
  - {name: right, definition: finger.yaml, position: [0.04, 0, 0.02]}
"""
SCENE = """
manipulators:
  - definition: pair.yaml
    base: free
    actuation: [{limbs: all, actuator: 0, axis: 0, torque: 0.01}]
    loads: [{link: right_tip, force: [0, 0.05, 0]}]
gravity: [0, 0, 0]
"""


@pytest.fixture
def here(tmp_path: Path) -> Path:
    shutil.copy(FOLDER / "finger.yaml", tmp_path)
    (tmp_path / "pair.yaml").write_text(PAIR, "utf-8")
    (tmp_path / "pair_scene.yaml").write_text(SCENE, "utf-8")
    return tmp_path


@pytest.mark.moderate
def test_build(somo: Somo, here: Path) -> None:
    limb = "limbs[1].definition.actuator_definitions[0].n_segments=2"
    done = somo("build", here / "pair.yaml", "--verify", "--tip-frame", "tip", "--set", limb)
    assert (done.returncode, done.stdout) == (0, "")
    said = "pair.urdf: 2 limbs, 13 links, 12 joints, 1.565 kg, 0.11 m long, world scale 20: "
    assert done.stderr == f"{said}20 times its size, for PyBullet; --scale 1 for other tools\n"
    robot = ET.parse(here / "pair.urdf").getroot()
    names = [link.get("name") for link in robot.findall("link")]
    assert names[0] == "base"
    assert names[11:] == [
        "right_actuator_0_segment_01",
        "right_actuator_0_segment_02",
        "left_tip",
        "right_tip",
    ]


def test_a_tip_frame_that_a_link_is_called(somo: Somo, here: Path) -> None:
    done = somo("build", here / "pair.yaml", "--tip-frame", "actuator_0_segment_01")
    assert done.returncode == 2
    assert "a link is named actuator_0_segment_01 already" in done.stderr
    assert not (here / "pair.urdf").exists()


@pytest.mark.moderate
def test_run(somo: Somo, here: Path) -> None:
    done = somo("run", here / "pair_scene.yaml", "--steps", "20", "-o", "-", "--quiet")
    assert (done.returncode, done.stderr) == (0, "")
    names = next(csv.reader(done.stdout.splitlines()))
    assert names[1] == "pair.left_actuator_0_joint_01.angle_rad"
    assert names[-10:-7] == [f"pair.right_tip.{axis}_m" for axis in "xyz"]
    assert names[-1] == "pair.base_pose.qw"  # its base is free
    assert len(done.stdout.splitlines()) == 22
    again = somo("run", here / "pair_scene.yaml", "--steps", "20", "-o", "-", "--quiet")
    assert again.stdout == done.stdout


@pytest.mark.moderate
def test_run_an_assembly_by_itself(somo: Somo, here: Path) -> None:
    done = somo("run", here / "pair.yaml", "--steps", "5", "-o", "-", "--quiet")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.moderate
def test_check_numerics(somo: Somo, here: Path) -> None:
    done = somo("check", "--numerics", "--json", here / "pair_scene.yaml")
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads(done.stdout)
    assert "many-joints" not in {finding["code"] for finding in found["findings"]}


@pytest.mark.slow
def test_report_with_other_numbers_of_segments(somo: Somo, here: Path) -> None:
    done = somo(
        "report", here / "pair_scene.yaml", "--duration", "0.05", "--time-steps", "2e-3,1e-3",
        "--integrators", "implicit", "--segments", "10,4", "--repeats", "1", "-o", here / "report",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    with (here / "report" / "report.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["segments"] for row in rows} == {"10", "4"}


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("command", "what_is"),
    [
        (("stiffness", "pair.yaml", "--tip-stiffness", "6"), "a calibration is"),
        (("torque", "pair.yaml", "--force", "0.7", "--pressure", "1e5"), "a calibration is"),
        (("damping", "pair.yaml", "--ratio", "0.1"), "a damping ratio is"),
        (("fit", "pair_scene.yaml", "--data", "pair.csv"), "a fit is"),
    ],
)
def test_calibrations_are_about_one_manipulator(
    somo: Somo, here: Path, command: tuple[str, ...], what_is: str
) -> None:
    (here / "pair.csv").write_text("time_s\n0\n", "utf-8")
    done = somo("calibrate", *command)
    assert (done.returncode, done.stdout) == (3, "")
    first, *_ = done.stderr.splitlines()
    assert first == (
        f"pair.yaml:4:1: error: this is an assembly, and {what_is} about one manipulator"
    )


@pytest.mark.moderate
def test_a_closed_form_is_about_one_manipulator(somo: Somo, here: Path) -> None:
    (here / "named.yaml").write_text(SCENE + "reference: end_moment\n", "utf-8")
    done = somo("report", here / "named.yaml", "--duration", "0.05")
    assert done.returncode == 3
    assert "it is about a manipulator by itself, not an assembly" in done.stderr


@pytest.mark.moderate
def test_a_finding_is_about_the_part_of_the_limb(somo: Somo, here: Path) -> None:
    text = (here / "finger.yaml").read_text("utf-8")
    assert text.count("[0.015]") == 1
    tiny = text.replace("[0.015]", "[0.0001]")
    (here / "tiny.yaml").write_text(tiny, "utf-8")
    pair = PAIR.replace("right, definition: finger.yaml", "right, definition: tiny.yaml")
    (here / "pair.yaml").write_text(pair, "utf-8")
    scene = "manipulators: [{definition: pair.yaml, position: [0, 0, 0.1]}]\nground: {}\n"
    (here / "small.yaml").write_text(scene, "utf-8")
    done = somo("check", "--numerics", "--json", here / "small.yaml")
    (found,) = (
        one for one in json.loads(done.stdout)["findings"] if one["code"] == "small-for-contact"
    )
    lines = tiny.splitlines()
    assert Path(found["path"]).name == "tiny.yaml"
    assert lines[found["line"] - 2].startswith("tip_definition:")
    assert "right_actuator_0_segment_10" in found["message"]
