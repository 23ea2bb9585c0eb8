"""`somo calibrate` as a shell sees it: tables, files, patches, and what is said of wrong input."""

from __future__ import annotations

import json
import math
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest

from somo_cli.document.parse import parse
from tests.builders.command import SIMULATION, Somo, end_by, start_and_wait_for
from tests.builders.scenes import DEFINITIONS

pytestmark = pytest.mark.slow  # a process for each

RING = "time_s,tip.y_m\n" + "".join(
    f"{t!r},{0.01 + 0.005 * math.exp(-0.5 * t) * math.cos(15.6 * t)!r}\n"
    for t in (0.01 * n for n in range(300))
)
PRESSURES = "# Finger 3\npressure_pa,force_n\n2e4,0.14\n4e4,0.31\n6e4,0.44\n8e4,0.61\n1e5,0.75\n"


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with the shipped finger and its scene, the finger's springs taken away."""
    for name in ("finger.yaml", "scene.yaml"):
        shutil.copy(DEFINITIONS / name, tmp_path / name)
    return tmp_path


def joint_of(path: Path, axis: int) -> dict[str, float]:
    data = parse(path.read_text("utf-8"), str(path)).data
    assert isinstance(data, dict)
    found: dict[str, float] = data["actuator_definitions"][0]["joint_definitions"][axis]
    return found


def test_stiffness_is_patched_in_and_all_else_stays(somo: Somo, here: Path) -> None:
    before = (here / "finger.yaml").read_text("utf-8")
    (here / "finger.yaml").write_text(before.replace("0.117045\n", "87.4286\n"), "utf-8")
    ended = somo("calibrate", "stiffness", "--patch", "finger.yaml", "--tip-stiffness", "6.12")
    assert (ended.returncode, ended.stderr) == (0, "finger.yaml: patched\n")
    assert (here / "finger.yaml").read_text("utf-8") == before
    lines = ended.stdout.splitlines()
    assert lines[0] == "bends about [1, 0, 0], 5 joints at 5, 25, 45, 65, 85 mm of 100 mm"
    assert [line.split()[:2] for line in lines[2:4]] == [
        ["exact", "0.117045"],
        ["SoMo's", "formula"],
    ]
    assert lines[3].split()[2:] == ["0.218571", "11.4286", "+86.74", "%"]
    assert lines[-1].endswith("<- this one")


def test_a_copy_is_written_and_the_definition_stays(somo: Somo, here: Path) -> None:
    before = (here / "finger.yaml").read_bytes()
    ended = somo(
        "calibrate", "stiffness", "finger.yaml", "--axis", "1", "--rigidity", "0.01",
        "--rule", "somo", "--write", "new.yaml",
    )  # fmt: skip
    assert (ended.returncode, ended.stderr) == (0, "new.yaml: written\n")
    assert (here / "finger.yaml").read_bytes() == before
    tip = 3 * 0.01 / 0.1**3
    expected = 0.1**2 * tip / (3 / 10 - 1 / 50)
    assert joint_of(here / "new.yaml", 1)["spring_stiffness"] == pytest.approx(expected)
    assert somo("check", "new.yaml").returncode == 0


def test_without_a_definition_a_joint_is_written(somo: Somo, here: Path) -> None:
    ended = somo(
        "calibrate", "stiffness", "--length", "0.1", "--joints", "4", "--modulus", "5e5",
        "--section", "box:0.02,0.01", "--about", "y", "--placement", "gauss", "--write", "j.yaml",
    )  # fmt: skip
    assert (ended.returncode, ended.stderr) == (0, "j.yaml: written\n")
    data = parse((here / "j.yaml").read_text("utf-8"), "j.yaml").data
    rigidity = 5e5 * 0.01 * 0.02**3 / 12
    assert data == {
        "joint_type": "continuous",
        "axis": [0, 1, 0],
        "spring_stiffness": pytest.approx(4 * rigidity / 0.1),
    }
    # and it is ready to be named by a definition
    text = (here / "finger.yaml").read_text("utf-8")
    start = text.index("    joint_definitions:")
    end = text.index("base_definition:")
    text = text[:start].replace("planar_flag: 0", "planar_flag: 1") + (
        "    joint_definitions: [j.yaml]\n\n" + text[end:]
    )
    (here / "made.yaml").write_text(text, "utf-8")
    assert somo("check", "made.yaml").returncode == 0


def test_a_definition_alone_reports_its_tip_stiffness(somo: Somo, here: Path) -> None:
    ended = somo("calibrate", "stiffness", "finger.yaml", "--axis", "1", "--json")
    assert (ended.returncode, ended.stderr) == (0, "")
    about = json.loads(ended.stdout)
    assert about["tip_stiffness"] == pytest.approx(29.05)
    assert about["spring_stiffness"] == pytest.approx(0.41033125)
    assert [one["joints"] for one in about["chains"]][-3:] == [40, 40, 5]
    assert about["chains"][1]["placement"] == "gauss"
    assert about["chains"][1]["moment"] == pytest.approx(0, abs=1e-12)


def test_torque_per_pressure_is_what_scenes_are_driven_by(somo: Somo, here: Path) -> None:
    ended = somo(
        "calibrate", "torque", "--patch", "finger.yaml", "--force", "0.5", "--pressure", "5e4"
    )
    assert (ended.returncode, ended.stderr) == (0, "finger.yaml: patched\n")
    per_pressure = joint_of(here / "finger.yaml", 0)["torque_per_pressure"]
    row = ended.stdout.splitlines()[2].split()
    assert row[:2] == ["50000", "0.5"]
    assert per_pressure * 5e4 == pytest.approx(float(row[2]), rel=1e-5)
    assert float(row[3]) == pytest.approx(0.5 * 0.02295 / 0.33, rel=0.01)  # small angles
    assert float(row[4]) == pytest.approx(0.05)  # SoMo's
    run = somo(
        "run", "scene.yaml", "--steps", "0", "-o", "-", "--set", "record.columns=[actuation]",
        "--set", "manipulators[0].actuation=[{actuator: 0, axis: 0, pressure: 2e4}]",
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    assert float(run.stdout.splitlines()[1].split(",")[1]) == pytest.approx(2e4 * per_pressure)


def test_several_pressures_make_a_line(somo: Somo, here: Path) -> None:
    (here / "p.csv").write_text(PRESSURES, "utf-8")
    ended = somo(
        "calibrate", "torque", "finger.yaml", "--data", "p.csv", "--small-angles", "--json"
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    about = json.loads(ended.stdout)
    factor = about["points"][0]["torque_small_angles"] / 0.14
    forces = (0.14, 0.31, 0.44, 0.61, 0.75)
    slope, offset = np.polyfit((2e4, 4e4, 6e4, 8e4, 1e5), forces, 1)
    assert about["torque_per_pressure"] == pytest.approx(slope * factor)
    assert about["offset"] == pytest.approx(offset * factor)
    assert about["torque_per_pressure_error"] > 0
    assert len(about["residuals"]) == 5


def test_an_offset_of_the_line_is_reported(somo: Somo, here: Path) -> None:
    text = "pressure_pa,force_n\n1e4,0\n2e4,0.1\n3e4,0.201\n4e4,0.3\n"
    (here / "p.csv").write_text(text, "utf-8")
    said = somo("calibrate", "torque", "finger.yaml", "--data", "p.csv").stderr
    assert said.startswith("somo: warning: at zero pressure the line has -0.00")
    assert (
        somo("calibrate", "torque", "finger.yaml", "--data", "p.csv", "--through-zero").stderr == ""
    )


def test_without_pressure_a_torque_for_a_scene_is_written(somo: Somo, here: Path) -> None:
    ended = somo(
        "calibrate", "torque", "--length", "0.1", "--joints", "5", "--axes", "2", "--force", "0.75",
        "--write", "t.yaml",
    )  # fmt: skip
    assert ended.returncode == 0
    data = parse((here / "t.yaml").read_text("utf-8"), "t.yaml").data
    assert data == {"actuator": 0, "axis": 0, "torque": pytest.approx(0.0521590909)}


def test_a_ring_down_gives_damping(somo: Somo, here: Path) -> None:
    (here / "ring.csv").write_text(RING, "utf-8")
    ended = somo("calibrate", "damping", "--patch", "finger.yaml", "--ring-down", "ring.csv")
    assert (ended.returncode, ended.stderr) == (0, "finger.yaml: patched\n")
    assert "measured                 15.608 ± " in ended.stdout
    ratio = 0.5 / np.hypot(0.5, 15.6)
    joint = joint_of(here / "finger.yaml", 0)
    assert joint["spring_damping"] / 0.117045 == pytest.approx(2 * ratio / 15.659, rel=1e-4)


def test_a_ring_down_at_another_frequency_gives_a_warning(somo: Somo, here: Path) -> None:
    (here / "ring.csv").write_text(RING.replace("tip.y_m", "y"), "utf-8")
    ended = somo("calibrate", "damping", "finger.yaml", "--axis", "1", "--ring-down", "ring.csv")
    assert ended.returncode == 0
    assert ended.stderr.splitlines() == [
        "somo: warning: the model swings at 34.4 rad/s, the measured motion at 15.61 rad/s",
        "  hint: stiffness over inertia should be 0.206 times as large: check mass, stiffness, "
        "gravity, and the pose of the scene",
    ]


def test_damping_from_a_ratio_in_the_pose_of_a_scene(somo: Somo, here: Path) -> None:
    alone = somo("calibrate", "damping", "finger.yaml", "--ratio", "0.1", "--json")
    standing = somo("calibrate", "damping", "scene.yaml", "--ratio", "0.1", "--json")
    found = [json.loads(ended.stdout) for ended in (alone, standing)]
    assert found[0]["frequency_model"] == pytest.approx(15.659, rel=1e-4)
    assert found[1]["frequency_model"] < found[0]["frequency_model"]
    # the slower swing takes less damping for the same ratio
    assert found[1]["spring_damping"][0] < found[0]["spring_damping"][0]


def test_a_fit_recovers_the_parameters_of_a_run(somo: Somo, here: Path) -> None:
    pytest.importorskip("pybullet")
    drive = "manipulators[0].actuation=[{actuator: 0, axis: 0, pressure: 6e4}]"
    assert somo("run", "scene.yaml", "--steps", "600", "--set", drive, "-q").returncode == 0
    text = (here / "scene.yaml").read_text("utf-8")
    start, end = text.index("    actuation:"), text.index("record:")
    text = text[:start] + "    actuation: [{actuator: 0, axis: 0, pressure: 6e4}]\n" + text[end:]
    (here / "scene.yaml").write_text(text, "utf-8")
    wrong = (here / "finger.yaml").read_text("utf-8").replace(": 0.117045\n", ": 0.15\n")
    wrong = wrong.replace("4.88195372e-07", "4e-07").replace("0.00045\n", "0.001\n")
    (here / "finger.yaml").write_text(wrong, "utf-8")
    ended = somo(
        "calibrate", "fit", "scene.yaml", "--data", "scene.csv", "--columns",
        "finger.tip.y_m,tip.z_m,actuator_0_joint_01.angle_rad", "--patch", here / "finger.yaml",
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    joint = joint_of(here / "finger.yaml", 0)
    assert joint["spring_stiffness"] == pytest.approx(0.117045, rel=1e-3)
    assert joint["spring_damping"] == pytest.approx(0.00045, rel=1e-3)
    assert joint["torque_per_pressure"] == pytest.approx(4.88195372e-07, rel=1e-3)
    # a motion in one plane does not depend on the other axis
    said = ended.stderr.splitlines()
    assert said[:2] == [
        "somo: warning: the data do not depend on the stiffness of actuator 0, axis 1, which stays "
        "at 0.410331",
        "somo: warning: the data do not depend on the damping of actuator 0, axis 1, which stays "
        "at 0.00072",
    ]
    kept = [line for line in wrong.splitlines() if "#" in line]
    assert [line for line in (here / "finger.yaml").read_text().splitlines() if "#" in line] == kept


def test_the_gain_of_a_torque_is_left_to_the_scene(somo: Somo, here: Path) -> None:
    pytest.importorskip("pybullet")
    assert somo("run", "scene.yaml", "--steps", "300", "-q").returncode == 0
    text = (here / "scene.yaml").read_text("utf-8")
    (here / "scene.yaml").write_text(text.replace("[0.5, 0.03]", "[0.5, 0.024]"), "utf-8")
    before = joint_of(here / "finger.yaml", 0)
    ended = somo(
        "calibrate", "fit", "scene.yaml", "--data", "scene.csv", "--parameters",
        "damping,gain", "--patch", "finger.yaml",
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    said = [line for line in ended.stderr.splitlines() if "warning" not in line]
    assert said == [
        "finger.yaml: patched",
        "scene.yaml: multiply the torques by the gain of actuator 0, axis 0, 1.25, by hand",
        "scene.yaml: multiply the torques by the gain of actuator 0, axis 1, 1.25, by hand",
    ]
    after = joint_of(here / "finger.yaml", 0)
    assert after["torque_per_pressure"] == before["torque_per_pressure"]
    assert after["spring_damping"] == pytest.approx(before["spring_damping"], rel=1e-3)
    only = somo(
        "calibrate", "fit", "scene.yaml", "--data", "scene.csv", "--parameters", "gain",
        "--patch", "finger.yaml",
    )  # fmt: skip
    assert only.returncode == 2
    assert "only torque gains are fitted; a definition has no torques" in only.stderr


FIT = ("calibrate", "fit", "scene.yaml", "--data", "m.csv")
RINGS = ("calibrate", "damping", "finger.yaml", "--ring-down", "m.csv")
FORCES = ("calibrate", "torque", "finger.yaml", "--data", "m.csv")


@pytest.mark.parametrize(
    ("arguments", "text", "said"),
    [
        (
            FIT,
            "time_s,tip.x_m\n" + "".join(f"0.0{n},1\n" for n in (0, 1, 2, 3, 3, 5, 6, 7, 8)),
            ["m.csv:6:1: error: 'time_s' must increase, found 0.03 after 0.03"],
        ),
        (
            FIT,
            "time,tip.x_m\n0,1\n0.1,b\n",
            ["m.csv:3:5: error: not a number: 'b'"],
        ),
        (
            FIT,
            "time,tip.x_m\n0,1\n0.1,2\n",
            [
                "m.csv:1:1: error: there is no column 'time_s'",
                "m.csv:1:1: error: 2 rows, but a fit needs at least 8",
            ],
        ),
        (
            FIT,
            "time_s,tp.x_m\n" + "".join(f"0.0{n},1\n" for n in range(9)),
            ["m.csv:1:8: error: the scene records no column 'tp.x_m'"],
        ),
        (
            RINGS,
            "time_s,a,b\n" + "".join(f"{n},1,2\n" for n in range(9)),
            ["m.csv:1:1: error: there are 2 columns besides time_s: a, b"],
        ),
        (
            RINGS,
            "time_s,a\n" + "".join(f"{n},1\n" for n in range(9)),
            ["m.csv:1:8: error: the values are constant, 1: there is no swing in the record"],
        ),
        (
            FORCES,
            "pressure_pa,force\n1,2\n2,3\n",
            [
                "m.csv:1:1: error: there is no column 'force_n'",
                "m.csv:1:1: error: 2 rows, but a line with an error needs at least 3",
            ],
        ),
        (FORCES, "", ["m.csv:1:1: error: the file is empty"]),
    ],
)
def test_wrong_recordings(
    somo: Somo, here: Path, arguments: tuple[str, ...], text: str, said: list[str]
) -> None:
    (here / "m.csv").write_text(text, "utf-8")
    before = (here / "finger.yaml").read_bytes()
    ended = somo(*arguments, "--patch", "finger.yaml")
    assert (ended.returncode, ended.stdout) == (3, "")
    assert [line for line in ended.stderr.splitlines() if ": error: " in line] == said
    assert (here / "finger.yaml").read_bytes() == before


TIP = ("calibrate", "stiffness", "finger.yaml")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((*TIP, "--tip-stiffness", "-6.12"), "-6.12 is not greater than 0, and finite"),
        ((*TIP, "--tip-stiffness", "1", "--rigidity", "1"), "give one of --tip-stiffness"),
        ((*TIP, "--modulus", "1e6", "--section", "bx:1"), "'bx:1' is not a known shape"),
        ((*TIP, "--axis", "2", "--tip-stiffness", "1"), "axis 2 of actuator 0 does not exist"),
        ((*TIP, "--actuator", "1", "--tip-stiffness", "1"), "there is no actuator 1"),
        ((*TIP, "--at", "0.2", "--tip-stiffness", "1"), "0.2 m is not a place on the 0.1 m"),
        ((*TIP, "--numbers", "3;5", "--tip-stiffness", "1"), "'3;5' is not a list of numbers"),
        ((*TIP, "--rule", "beam", "--tip-stiffness", "1"), "'beam' is not exact or somo"),
        ((*TIP, "--patch", "scene.yaml", "--tip-stiffness", "1"), "another definition than finger"),
        (("calibrate", "stiffness", "--tip-stiffness", "1"), "give a definition, or --length and"),
        (
            ("calibrate", "stiffness", "--length", "1", "--places", "0.1;0.2", "--rigidity", "1"),
            "'0.1;0.2' is not a list of places in metres",
        ),
        (
            ("calibrate", "torque", "--length", "1", "--places", "0.1,1.2", "--force", "1"),
            "a joint at 1.2 m is not on the 1 m of actuator",
        ),
        (
            ("calibrate", "stiffness", "--length", "-1", "--joints", "2", "--tip-stiffness", "1"),
            "-1.0 is not greater than 0",
        ),
        (("calibrate", "torque", "finger.yaml"), "give --force or --data"),
        (
            ("calibrate", "torque", "--patch", "finger.yaml", "--force", "1"),
            "give --pressure as well",
        ),
        (
            ("calibrate", "torque", "finger.yaml", "--force", "0"),
            "0.0 is not a finite force other than 0",
        ),
        (("calibrate", "damping", "finger.yaml"), "give --ratio or --ring-down"),
        (("calibrate", "damping", "finger.yaml", "--ratio", "-1"), "-1.0 is not from 0 to 10"),
        (
            ("calibrate", "damping", "finger.yaml", "--ratio", "1", "--axis", "3"),
            "axis 3 of actuator 0 moves no joint",
        ),
        (
            ("calibrate", "damping", "finger.yaml", "--ratio", "1", "--patch", "scene.yaml"),
            "scene.yaml is not one of the files that were read: finger.yaml",
        ),
        (
            (*TIP, "--write", "finger.yaml"),
            "finger.yaml is one of the files that are read: change it",
        ),
        (
            (*FIT, "--write", "./scene.yaml"),
            "./scene.yaml is one of the files that are read: change it",
        ),
        ((*FIT, "--parameters", "mass"), "'mass' is not one of stiffness, damping, gain"),
    ],
)
def test_wrong_usage(somo: Somo, here: Path, arguments: tuple[str, ...], message: str) -> None:
    ended = somo(*arguments)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert message in " ".join(ended.stderr.split())
    assert "Traceback" not in ended.stderr


def test_a_scene_is_not_calibrated(somo: Somo, here: Path) -> None:
    ended = somo("calibrate", "stiffness", "scene.yaml", "--tip-stiffness", "1")
    assert ended.returncode == 3
    assert "error: this is a scene, not a manipulator definition" in ended.stderr


def test_a_scene_of_several_is_not_fitted(somo: Somo, here: Path) -> None:
    text = (here / "scene.yaml").read_text("utf-8")
    two = "  - {definition: finger.yaml, name: other, position: [1, 0, 0]}\nrecord:"
    (here / "scene.yaml").write_text(text.replace("record:", two), "utf-8")
    (here / "m.csv").write_text(RING, "utf-8")
    for command in (FIT, ("calibrate", "damping", "scene.yaml", "--ratio", "0.1")):
        ended = somo(*command)
        assert ended.returncode == 3
        assert "there are several manipulators" in ended.stderr


def test_what_an_alias_shares_is_not_patched(somo: Somo, here: Path) -> None:
    text = (here / "finger.yaml").read_text("utf-8")
    text = text.replace("spring_stiffness: 0.117045", "spring_stiffness: &k 0.2")
    text = text.replace("spring_stiffness: 0.41033125", "spring_stiffness: *k")
    (here / "finger.yaml").write_text(text, "utf-8")
    ended = somo("calibrate", "stiffness", "--patch", "finger.yaml", "--tip-stiffness", "6.12")
    assert ended.returncode == 3
    assert "error: this value cannot be set by itself" in ended.stderr
    assert "hint: set spring_stiffness: 0.117045 by hand" in ended.stderr
    assert (here / "finger.yaml").read_text("utf-8") == text


def test_a_fit_can_be_interrupted(here: Path, environment: dict[str, str]) -> None:
    pytest.importorskip("pybullet")
    rows = "".join(f"{0.01 * n!r},{0.001 * n!r}\n" for n in range(1, 400))
    (here / "m.csv").write_text("time_s,tip.y_m\n" + rows, "utf-8")
    before = (here / "finger.yaml").read_bytes()
    command = [*map(str, FIT), "--patch", "finger.yaml"]
    with start_and_wait_for(SIMULATION, command, here, environment) as process:
        ended = end_by(process, signal.SIGINT)
    assert ended == (130, "", "somo: interrupted\n")
    assert (here / "finger.yaml").read_bytes() == before


def test_a_modulus_takes_the_section_of_the_definition(somo: Somo) -> None:
    finger = DEFINITIONS / "finger.yaml"  # 23 mm by 17 mm
    asked = ("calibrate", "stiffness", finger, "--modulus", "5e5", "--json")
    found, drawn = somo(*asked), somo(*asked, "--section", "box:0.023,0.017")
    assert (found.returncode, found.stdout) == (0, drawn.stdout)
    bare = somo("calibrate", "stiffness", "--length", "0.1", "--joints", "5", "--modulus", "5e5")
    assert bare.returncode == 2
    assert "it goes with --modulus" in bare.stderr


def test_measurements_may_be_in_the_units_of_a_lab(somo: Somo, tmp_path: Path) -> None:
    rows = [(2e4, 0.14), (4e4, 0.31), (6e4, 0.44), (8e4, 0.61), (1e5, 0.75)]
    lab = "".join(f"{pressure / 1e3!r},{force * 1e3!r}\n" for pressure, force in rows)
    own = "".join(f"{pressure!r},{force!r}\n" for pressure, force in rows)
    (tmp_path / "lab.csv").write_text("pressure_kpa,force_mn\n" + lab, "utf-8")
    (tmp_path / "si.csv").write_text("pressure_pa,force_n\n" + own, "utf-8")
    asked = ("calibrate", "torque", DEFINITIONS / "finger.yaml", "--json", "--data")
    converted, plain = somo(*asked, "lab.csv"), somo(*asked, "si.csv")
    assert converted.returncode == plain.returncode == 0
    assert converted.stderr.splitlines()[:2] == [
        "somo: lab.csv: pressure_kpa is taken as pressure_pa, times 1000",
        "somo: lab.csv: force_mn is taken as force_n, times 0.001",
    ]
    found, known = json.loads(converted.stdout)["points"], json.loads(plain.stdout)["points"]
    assert len(found) == len(known) == 5
    for one, other in zip(found, known, strict=True):
        assert one == pytest.approx(other, rel=1e-12)
