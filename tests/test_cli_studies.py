"""`report`, `run --error`, `run --time-step auto` and `check --numerics` as a shell sees them."""

from __future__ import annotations

import csv
import json
import signal
from pathlib import Path

import pytest

from tests.builders.command import SIMULATION, Somo, end_by, start_and_wait_for
from tests.builders.scenes import DEFINITIONS

pytestmark = pytest.mark.slow  # a process for each

SCENE = DEFINITIONS / "scene.yaml"
QUICK = ("--duration", "0.2", "--time-steps", "4e-3,2e-3", "--repeats", "1")
PNG = b"\x89PNG\r\n\x1a\n"


def test_a_report_is_a_table_a_sentence_and_four_files(somo: Somo, tmp_path: Path) -> None:
    # an error that only one of the integrators reaches, whatever the times
    ended = somo("report", SCENE, *QUICK, "--target", "5e-4", "-o", "out")
    assert ended.returncode == 0, ended.stderr
    lines = ended.stdout.splitlines()
    assert lines[0].split()[:3] == ["joints", "integrator", "step"]
    assert [line.split()[1] for line in lines[1:7]] == ["implicit"] * 2 + ["euler"] * 2 + [
        "explicit"
    ] * 2
    assert lines[-1].startswith("for 0.05 % tip error use implicit, dt = 0.00")
    assert lines[-1].endswith("x real time")
    assert ended.stderr == "out: report.csv, report.json, report.png, report.svg\n"
    folder = tmp_path / "out"
    with (folder / "report.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["status"] for row in rows] == ["ok"] * 4 + ["diverged"] * 2
    assert float(rows[0]["tip_position_max_m"]) > 3 * float(rows[1]["tip_position_max_m"])
    about = json.loads((folder / "report.json").read_text("utf-8"))
    assert about["choice"] == lines[-1]
    assert set(about["inputs"]) == {str(SCENE), str(DEFINITIONS / "finger.yaml")}
    again = somo("report", SCENE, *QUICK, "-o", "out", "--json", "-q")
    assert (again.returncode, again.stderr) == (0, "")
    assert again.stdout == (folder / "report.json").read_text("utf-8")
    assert (folder / "report.png").read_bytes().startswith(PNG)
    assert b"<svg" in (folder / "report.svg").read_bytes()


def test_a_report_over_segments_names_the_balanced_case(somo: Somo) -> None:
    ended = somo(
        "report", DEFINITIONS / "cantilever_scene.yaml", "--set", "reference=elastica",
        "--segments", "5,10", "--duration", "12", "--time-steps", "2e-2", "--integrators",
        "implicit", "--repeats", "1", "--target", "0.002", "-q",
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    lines = ended.stdout.splitlines()
    assert lines[0].split()[0] == "segments"
    assert any(
        line.startswith("5 segments: model error against elastica: tip 3.3") for line in lines
    )
    assert any(
        line.startswith("balanced: 5 segments, implicit, dt = 0.02 s: solver") for line in lines
    )
    assert lines[-1].startswith("for 0.2 % tip error use 10 segments, implicit, dt = 0.02 s: ")
    assert ended.stderr == ""


def test_without_matplotlib_a_report_has_no_picture_and_says_so(
    somo: Somo, tmp_path: Path, environment: dict[str, str]
) -> None:
    (tmp_path / "none" / "matplotlib").mkdir(parents=True)
    (tmp_path / "none" / "matplotlib" / "__init__.py").write_text("raise ImportError('hidden')\n")
    path = f"{tmp_path / 'none'}:{environment['PYTHONPATH']}"
    ended = somo("report", SCENE, *QUICK, env={"PYTHONPATH": path})
    assert ended.returncode == 0
    assert "somo: the picture needs matplotlib: pip install 'somo-cli[plot]'\n" in ended.stderr
    found = sorted(one.name for one in (tmp_path / "scene_report").iterdir())
    assert found == ["report.csv", "report.json"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--time-steps", "1e-3,x"), "'1e-3,x' is not a list of numbers, such as 0.001,0.002"),
        (("--time-steps", "0,1e-3"), "0.0 is not greater than 0 and at most 1"),
        (("--time-steps", "1e-3,1.1e-3,1.3e-3,1.7e-3"), "choose steps that are multiples"),
        (("--integrators", "implicit,rk4"), "'rk4' is not one of implicit, euler, explicit"),
        (("--segments", "5,many"), "'many' is not a number of segments, 1 to 121"),
        (("--duration", "0"), "0.0 is not greater than 0"),
        (("--target", "1"), "1.0 is not between 0 and 1"),
    ],
)
def test_wrong_usage_of_report(
    somo: Somo, tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    ended = somo("report", SCENE, *arguments)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert message in " ".join(ended.stderr.split())
    assert list(tmp_path.iterdir()) == []


def test_a_scene_without_uniform_segments_is_wrong_usage(somo: Somo) -> None:
    ended = somo("report", DEFINITIONS / "planar_finger_scene.yaml", *QUICK, "--segments", "8")
    assert ended.returncode == 2
    assert "joints of actuator 0 differ along it" in " ".join(ended.stderr.split())


def test_a_reference_that_does_not_fit_is_an_error_of_the_scene(somo: Somo, tmp_path: Path) -> None:
    scene = (DEFINITIONS / "cantilever_scene.yaml").read_text("utf-8")
    (tmp_path / "cantilever.yaml").write_text((DEFINITIONS / "cantilever.yaml").read_text("utf-8"))
    (tmp_path / "scene.yaml").write_text(scene + "\nreference: pendulum\n")
    ended = somo("report", "scene.yaml", *QUICK)
    assert (ended.returncode, ended.stdout) == (3, "")
    line = len(scene.splitlines()) + 2
    assert ended.stderr.startswith(
        f"scene.yaml:{line}:12: error: the closed form 'pendulum' does not describe this scene: "
        "it is about a single joint, not 10\n"
    )


def test_a_report_interrupted_leaves_nothing(tmp_path: Path, environment: dict[str, str]) -> None:
    command = ["report", str(SCENE), "--duration", "60"]
    with start_and_wait_for(SIMULATION, command, tmp_path, environment) as process:
        ended = end_by(process, signal.SIGINT, 0.5)
    assert ended == (130, "", "somo: interrupted\n")
    assert list(tmp_path.iterdir()) == []


STRUCK = "manipulators[0].initial_rates=10"


def test_a_run_reports_its_error(somo: Somo, tmp_path: Path) -> None:
    ended = somo("run", SCENE, "--steps", "200", "--every", "50", "--error")
    assert ended.returncode == 0
    lines = ended.stderr.splitlines()
    assert lines[0].startswith("scene.csv: 5 rows of 14 columns; ")
    assert lines[1].startswith("estimated error, by the same scene at 0.002 and 0.0005 s (")
    assert lines[2].split()[:2] == ["worst", "columns"]
    assert len(lines) == 3 + 5 + 1
    assert lines[-1].startswith("converged to 0.00")
    names = (tmp_path / "scene.csv").read_text("utf-8").splitlines()[0].split(",")
    about = json.loads((tmp_path / "scene.meta.json").read_text("utf-8"))["error"]
    assert about["order"] == 2
    assert about["verdict"] == lines[-1]
    assert about["is_converged"] is True
    assert list(about["columns"]) == names[1:]
    listed = [line.split()[0] for line in lines[3:-1]]
    assert listed == [one["column"] for one in about["worst"]]
    relative = [one["relative"] for one in about["worst"]]
    assert relative == sorted(relative, reverse=True)
    assert relative[0] == max(one["relative"] for one in about["columns"].values())
    first = about["columns"][names[1]]
    assert first["relative"] == first["judged"] / first["scale"]
    assert 0 < first["rms"] <= first["max"] < 1e-3
    plain = somo("run", SCENE, "--steps", "200", "--every", "50", "-o", "-", "-q")
    assert plain.stdout == (tmp_path / "scene.csv").read_text("utf-8")


def test_a_run_that_is_not_converged_says_so_and_what_to_try(somo: Somo, tmp_path: Path) -> None:
    options = ("--time-step", "0.02", "--set", "manipulators[0].actuation=[]")
    ended = somo("run", SCENE, "--steps", "20", *options, "--set", STRUCK, "--error")
    assert ended.returncode == 0
    last = ended.stderr.splitlines()[-1]
    assert last.startswith("NOT converged: finger.")
    assert " of its range); try --time-step 0.0" in last
    about = json.loads((tmp_path / "scene.meta.json").read_text("utf-8"))["error"]
    assert (about["verdict"], about["is_converged"]) == (last, False)


def test_an_error_is_reported_beside_a_pipe(somo: Somo) -> None:
    ended = somo("run", SCENE, "--steps", "20", "--every", "10", "--error", "-o", "-")
    assert len(ended.stdout.splitlines()) == 4
    assert ended.stderr.splitlines()[0].startswith("standard output: 3 rows")


def test_a_step_is_chosen_and_recorded(somo: Somo, tmp_path: Path) -> None:
    ended = somo("run", SCENE, "--steps", "10", "--time-step", "auto")
    assert ended.returncode == 0
    assert ", time step 0.01 s, " in ended.stderr
    about = json.loads((tmp_path / "scene.meta.json").read_text("utf-8"))
    assert (about["time_step_s"], about["time_step_chosen"]) == (0.01, True)
    assert 0 < about["expected_tip_error_relative"] < 0.01
    set_in_scene = somo("run", SCENE, "--steps", "10", "--set", "time_step=auto", "-o", "-", "-q")
    assert set_in_scene.stdout == (tmp_path / "scene.csv").read_text("utf-8")
    wrong = somo("run", SCENE, "--steps", "10", "--time-step", "automatic")
    assert wrong.returncode == 2
    assert "neither a number nor auto" in wrong.stderr


def test_numerics_are_a_table_and_findings(somo: Somo) -> None:
    ended = somo("check", SCENE, "--numerics")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout.splitlines()[0].split() == ["finger:", "10", "joints", "start", "neutral"]
    assert "implicit at 0.001 s: stable; a tip error of about" in ended.stdout


@pytest.fixture
def explicit(tmp_path: Path) -> Path:
    """A scene at a step that its explicit integrator cannot hold."""
    for name in ("scene.yaml", "finger.yaml"):
        text = (DEFINITIONS / name).read_text("utf-8")
        (tmp_path / name).write_text(text.replace("integrator: implicit", "integrator: explicit"))
    return tmp_path / "scene.yaml"


def test_an_unstable_step_is_an_error_with_its_place(somo: Somo, explicit: Path) -> None:
    assert somo("check", explicit.name).returncode == 0
    ended = somo("check", explicit.name, "--numerics")
    assert ended.returncode == 1
    assert ended.stderr == (
        "scene.yaml:6:12: error: a step of 0.001 s is above the limit of the explicit "
        "integrator, 0.000376 s\n"
        "    time_step: 1e-3\n"
        "               ^^^^\n"
        "  hint: time_step: 0.0002, or integrator: implicit with time_step: 0.01\n"
    )
    assert "explicit at 0.001 s: unstable, 2.66 times its limit" in ended.stdout
    found = json.loads(somo("check", explicit.name, "--numerics", "--json").stdout)
    assert [one["code"] for one in found["findings"]] == ["explicit-step-too-long"]
    assert found["findings"][0]["line"] == 6
    assert found["explicit_step_s"] == pytest.approx(0.000376, rel=1e-2)
    assert somo("run", explicit.name, "--steps", "2000").returncode == 4


def test_strict_counts_warnings(somo: Somo) -> None:
    arm = DEFINITIONS / "arm.yaml"
    for arguments, code in (((), 0), (("--numerics",), 0), (("--numerics", "--strict"), 1)):
        assert somo("check", arm, *arguments).returncode == code
    assert somo("check", arm, "--strict").returncode == 0


def test_the_worst_pose_of_a_run_is_examined(somo: Somo) -> None:
    somo("run", SCENE, "--steps", "1000")
    ended = somo("check", SCENE, "--numerics", "--trajectory", "scene.csv")
    assert ended.returncode == 0
    assert ended.stdout.splitlines()[0].split()[-1] == "worst"
    other = somo("check", DEFINITIONS / "arm_scene.yaml", "--numerics", "--trajectory", "scene.csv")
    assert other.returncode == 3
    assert other.stderr.startswith("scene.csv:1:1: error: there is no column 'arm.")
    missing = somo("check", SCENE, "--numerics", "--trajectory", "none.csv")
    assert (missing.returncode, missing.stderr) == (
        5,
        "somo: none.csv: No such file or directory\n",
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--numerics", str(SCENE)), "it takes one scene, not 2"),
        (("--trajectory", "x.csv"), "it goes with --numerics"),
    ],
)
def test_wrong_usage_of_check(somo: Somo, arguments: tuple[str, ...], message: str) -> None:
    ended = somo("check", SCENE, *arguments)
    assert ended.returncode == 2
    assert message in ended.stderr


def test_numerics_of_an_invalid_file_are_its_errors(somo: Somo, tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text("manipulators: []\ntime_step: -1\n")
    ended = somo("check", "bad.yaml", "--numerics")
    assert (ended.returncode, ended.stdout) == (1, "")
    assert "bad.yaml:2:12: error: -1 must be greater than 0" in ended.stderr
    found = json.loads(somo("check", "bad.yaml", "--numerics", "--json").stdout)
    assert {one["severity"] for one in found["findings"]} == {"error"}


def test_numerics_need_no_engine(somo: Somo, tmp_path: Path, environment: dict[str, str]) -> None:
    (tmp_path / "none").mkdir()
    (tmp_path / "none" / "pybullet.py").write_text("raise ImportError('hidden')\n")
    path = f"{tmp_path / 'none'}:{environment['PYTHONPATH']}"
    assert somo("check", SCENE, "--numerics", env={"PYTHONPATH": path}).returncode == 0
    assert somo("report", SCENE, *QUICK, env={"PYTHONPATH": path}).returncode == 5
