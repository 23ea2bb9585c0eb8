"""The real command in processes of its own: exit codes, streams, files, and what it imports."""

from __future__ import annotations

import csv
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import somo_cli
from somo_cli import __version__
from tests.builders.command import Somo

VALID = Path(__file__).parent / "cases" / "valid"
Start = Callable[..., "subprocess.Popen[str]"]

COMMANDS = ("build", "run", "check", "examples")
HEAVY = {"numpy", "pybullet", "rich", "scipy", "trimesh", "yourdfpy"}

BENT = """\
manipulators:
  - definition: smallest.yaml
    rpy: [0, 1.5, 0]
    actuation: [{actuator: 0, axis: 0, torque: 0.01}]
"""
DIVERGING = BENT + "integrator: explicit\ntime_step: 0.05\n"


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """The folder in which the command runs, with some definitions and scenes in it."""
    shutil.copytree(VALID, tmp_path, dirs_exist_ok=True)
    (tmp_path / "bent.yaml").write_text(BENT)
    (tmp_path / "diverging.yaml").write_text(DIVERGING)
    return tmp_path


def names(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def columns(path: Path) -> dict[str, list[float]]:
    with path.open(newline="") as stream:
        header, *rows = csv.reader(stream)
    return {name: [float(row[i]) for row in rows] for i, name in enumerate(header)}


def plain(ended: subprocess.CompletedProcess[str]) -> None:
    assert "\x1b" not in ended.stdout + ended.stderr
    assert "Traceback" not in ended.stderr


# --- help and usage


def test_version(somo: Somo) -> None:
    ended = somo("--version")
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, f"somo {__version__}\n", "")


def test_the_help_ends_with_the_exit_codes(somo: Somo) -> None:
    ended = somo("--help")
    assert (ended.returncode, ended.stderr) == (0, "")
    told = "Exit codes: 0 success, 1 problems found, others: see somo help commands."
    assert ended.stdout.splitlines()[-1].strip() == told


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("simulate",), "No such command 'simulate'."),
        (("build",), "Missing argument"),
        (("build", "smallest.yaml", "--colour"), "No such option: --colour"),
        (("build", "smallest.yaml", "tips.yaml"), "unexpected extra argument"),
        (("build", "smallest.yaml", "--scale", "0"), "0.0 is not from 1e-6 to 1e6"),
        (("build", "smallest.yaml", "--scale", "-1"), "-1.0 is not from 1e-6 to 1e6"),
        (("build", "smallest.yaml", "--scale", "nan"), "nan is not from 1e-6 to 1e6"),
        (
            ("build", "smallest.yaml", "--scale", "1e7"),
            "10000000.0 is not from 1e-6 to 1e6",
        ),
        (("build", "smallest.yaml", "--tip-frame", "a b"), "'a b' is not a safe name"),
        (("run", "smallest.yaml"), "--steps"),
        (("run", "smallest.yaml", "--steps", "-1"), "--steps"),
        (("run", "smallest.yaml", "--steps", "1.5"), "--steps"),
        (("run", "smallest.yaml", "--steps", "1", "--every", "0"), "--every"),
        (("run", "smallest.yaml", "--steps", "1", "--time-step", "0"), "0 is not greater"),
        (("run", "smallest.yaml", "--steps", "1", "--time-step", "2"), "2 is not greater"),
        (("check",), "Missing argument"),
    ],
)
def test_wrong_usage(somo: Somo, here: Path, arguments: tuple[str, ...], said: str) -> None:
    before = names(here)
    ended = somo(*arguments)
    plain(ended)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert said in ended.stderr
    assert names(here) == before


def test_no_command_at_all_shows_the_help(somo: Somo) -> None:
    ended = somo()
    assert ended.returncode == 2
    assert "Commands:" in ended.stdout + ended.stderr


@pytest.mark.moderate
@pytest.mark.parametrize(
    "arguments",
    [
        ("--help",),
        ("run", "--help"),
        ("build", "--scale"),
        ("check", "nothing.yaml"),
        ("check", "wrong.yaml"),
        ("run", "smallest.yaml", "--steps", "1"),
    ],
)
@pytest.mark.parametrize("loud", [{"CLICOLOR_FORCE": "1"}, {"GITHUB_ACTIONS": "true", "CI": "1"}])
def test_no_colour_goes_into_a_pipe(
    somo: Somo, here: Path, arguments: tuple[str, ...], loud: dict[str, str]
) -> None:
    (here / "wrong.yaml").write_text("manipulator_name: 3\n")
    ended = somo(*arguments, env=loud | {"TERM": "xterm-256color"})
    assert ended.stdout + ended.stderr
    plain(ended)


# --- check


def test_check_reports_all_problems_of_all_files(somo: Somo, here: Path) -> None:
    (here / "wrong.yaml").write_text("manipulator_name: my arm\nactuator_definitions: []\n")
    (here / "broken.yaml").write_text("a: b: c\n")
    ended = somo("check", "smallest.yaml", "wrong.yaml", "broken.yaml", "tips.yaml", "wrong.yaml")
    assert (ended.returncode, ended.stdout) == (1, "")
    heads = [line for line in ended.stderr.splitlines() if ": error: " in line]
    assert heads == [
        "wrong.yaml:1:19: error: 'my arm' is not a safe name",
        "wrong.yaml:2:23: error: expected at least 1 value, found 0",
        "broken.yaml:1:5: error: a ':' cannot stand here",
    ]


def test_check_goes_on_after_a_missing_file(somo: Somo, here: Path) -> None:
    (here / "wrong.yaml").write_text("[]")
    ended = somo("check", "none.yaml", "wrong.yaml", "parts")
    assert (ended.returncode, ended.stdout) == (5, "")
    assert ended.stderr.splitlines() == [
        "somo: none.yaml: No such file or directory",
        "somo: parts: Is a directory",
        "wrong.yaml:1:1: error: expected a mapping, found a list",
        "    []",
        "    ^",
    ]


@pytest.mark.moderate
def test_check_as_json(somo: Somo, here: Path) -> None:
    (here / "wrong.yaml").write_text("manipulators:\n  - definition: smallest.yaml\n    nam: ü\n")
    ended = somo("check", "--json", "wrong.yaml", "smallest.yaml")
    assert (ended.returncode, ended.stderr) == (1, "")
    assert json.loads(ended.stdout) == [
        {
            "code": "document",
            "path": "wrong.yaml",
            "line": 3,
            "column": 5,
            "severity": "error",
            "message": "unknown key 'nam'",
            "hint": "did you mean 'name'?",
        }
    ]
    fine = somo("check", "--json", "smallest.yaml")
    assert (fine.returncode, json.loads(fine.stdout), fine.stderr) == (0, [], "")


@pytest.mark.slow
def test_a_decomposition_is_announced_once(somo: Somo) -> None:
    pytest.importorskip("pybullet")
    scene = Path(__file__).parent / "objects" / "inputs" / "trough_mesh.yaml"
    sets = ("--set", "objects[0].hulls=decompose", "--set", "time_step=0.002")
    ended = somo("columns", scene, *sets)
    assert ended.returncode == 0
    (line,) = ended.stderr.splitlines()
    assert line.startswith("somo: decomposing ")
    assert line.endswith(" into convex parts, which may take half a minute")


# --- build


def test_build_takes_the_name_of_its_document(somo: Somo, here: Path) -> None:
    (here / "sub").mkdir()
    shutil.copy(here / "smallest.yaml", here / "sub")
    before = names(here)
    ended = somo("build", "sub/smallest.yaml")
    assert (ended.returncode, ended.stdout) == (0, "")
    assert ended.stderr == "smallest.urdf: 4 links, 3 joints, 0.03 kg, 0.3 m long, world scale 1\n"
    assert names(here) - before == {"smallest.urdf"}


def test_build_takes_the_name_in_the_document(somo: Somo, here: Path) -> None:
    before = names(here)
    ended = somo("build", "planar_true.yaml", "--quiet")
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    assert names(here) - before == {"planar.urdf"}


@pytest.mark.moderate
def test_build_to_standard_output_is_the_file(somo: Somo, here: Path) -> None:
    before = names(here)
    piped = somo("build", "smallest.yaml", "-o", "-")
    assert (piped.returncode, piped.stderr) == (0, "")
    assert names(here) == before
    assert somo("build", "smallest.yaml", "-o", "x.urdf", "-q").returncode == 0
    assert (here / "x.urdf").read_text("utf-8") == piped.stdout
    assert piped.stdout.endswith("</robot>\n")


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("arguments", "about"),
    [
        (("build", "none.yaml"), "none.yaml"),
        (("build", "parts"), "parts"),
        (("build", "smallest.yaml", "-o", "none/x.urdf"), "none/x.urdf"),
        (("build", "smallest.yaml", "-o", "parts"), "parts"),
        (("build", "smallest.yaml", "-o", "smallest.yaml/x"), "smallest.yaml/x"),
        (("run", "none.yaml", "--steps", "1"), "none.yaml"),
        (("run", "smallest.yaml", "--steps", "1", "-o", "none/x.csv"), "none/x.csv"),
    ],
)
def test_a_file_that_cannot_be_read_or_written(
    somo: Somo, here: Path, arguments: tuple[str, ...], about: str
) -> None:
    before = names(here)
    ended = somo(*arguments)
    plain(ended)
    assert (ended.returncode, ended.stdout) == (5, "")
    *warnings, last = ended.stderr.splitlines()
    assert last.startswith(f"somo: {about}: ")
    assert warnings == [] or "warning: nothing moves" in warnings[0]  # smallest.yaml stands still
    assert names(here) == before


@pytest.mark.moderate
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk(somo: Somo, here: Path) -> None:
    for arguments in (("build", "smallest.yaml"), ("run", "bent.yaml", "--steps", "5000")):
        ended = somo(*arguments, "-o", "/dev/full")
        plain(ended)
        assert (ended.returncode, ended.stdout) == (5, "")
        assert "No space left on device" in ended.stderr


def test_output_is_whole_or_not_there_at_all(here: Path, environment: dict[str, str]) -> None:
    (here / "x.urdf").write_text("old")
    before = names(here)
    ended = subprocess.run(
        [sys.executable, "-m", "somo_cli", "build", "smallest.yaml", "-o", "x.urdf"],
        cwd=here,
        env=environment | {"PYTHONDONTWRITEBYTECODE": "1"},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 5
    assert ended.stderr == "somo: x.urdf: File too large\n"
    assert (here / "x.urdf").read_text() == "old"
    assert names(here) == before


@pytest.mark.moderate
def test_a_wrong_definition_leaves_the_old_output(somo: Somo, here: Path) -> None:
    (here / "wrong.yaml").write_text("manipulator_name: 3\n")
    (here / "x.urdf").write_text("old")
    before = names(here)
    assert somo("build", "wrong.yaml", "-o", "x.urdf").returncode == 3
    assert somo("run", "wrong.yaml", "--steps", "1", "-o", "x.urdf").returncode == 3
    assert (here / "x.urdf").read_text() == "old"
    assert names(here) == before


def test_a_scene_is_not_built(somo: Somo, here: Path) -> None:
    ended = somo("build", "scene_smallest.yaml")
    assert (ended.returncode, ended.stdout) == (3, "")
    assert ended.stderr == (
        "scene_smallest.yaml:1:1: error: this is a scene, not a manipulator definition\n"
        "    manipulators: [{definition: smallest.yaml}]\n"
        "    ^^^^^^^^^^^^\n"
        "  hint: somo run takes scenes; build the definitions that this one names\n"
    )


@pytest.mark.moderate
def test_values_can_be_set(somo: Somo, here: Path) -> None:
    ended = somo(
        "build",
        "smallest.yaml",
        "--set",
        "actuator_definitions[0].n_segments=5",
        "--set",
        "manipulator_name=other",
        "--set",
        "base_definition=parts/link.yaml",
        "-o",
        "-",
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    assert '<robot name="other">' in ended.stdout
    assert ended.stdout.count("<joint ") == 5
    whole = somo("build", "smallest.yaml", "-o", "-").stdout
    assert ended.stdout.count("<link ") == whole.count("<link ") + 2


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("assignment", "said"),
    [
        (
            "actuator_definitions[0].n_segments=0",
            "--set 'actuator_definitions[0].n_segments':1:36: error: 0 must be at least 1\n"
            "    actuator_definitions[0].n_segments=0\n"
            "                                       ^\n"
            "  hint: number of joints [-]; the actuator has n_segments + 1 links\n",
        ),
        (
            "actuator_definitions[1].n_segments=3",
            "--set 'actuator_definitions[1].n_segments':1:21: error: 'actuator_definitions' has no "
            "item [1]\n"
            "    actuator_definitions[1].n_segments=3\n"
            "                        ^^^\n"
            "  hint: the last one is [0]\n",
        ),
        (
            "n_actt=1",
            "--set 'n_actt':1:1: error: unknown key 'n_actt'\n"
            "    n_actt=1\n"
            "    ^^^^^^\n"
            "  hint: did you mean 'n_act'?\n",
        ),
        (
            "n_act",
            "--set 'n_act':1:1: error: 'n_act' does not say what to set\n"
            "    n_act\n"
            "    ^^^^^\n"
            "  hint: write it like links[0].mass=0.1\n",
        ),
        (
            "tip_definition=none.yaml",
            "--set 'tip_definition':1:16: error: cannot read 'none.yaml': no such file or "
            "directory\n"
            "    tip_definition=none.yaml\n"
            "                   ^^^^^^^^^\n"
            "  hint: paths are relative to the file that names them, and stay in its folder or "
            "below\n",
        ),
    ],
)
def test_a_value_that_cannot_be_set(somo: Somo, here: Path, assignment: str, said: str) -> None:
    before = names(here)
    ended = somo("build", "smallest.yaml", "--set", assignment)
    assert (ended.returncode, ended.stdout, ended.stderr) == (3, "", said)
    assert names(here) == before


@pytest.mark.moderate
def test_scale_takes_the_place_of_that_in_the_file(somo: Somo, here: Path) -> None:
    by_file = somo("build", "smallest.yaml", "--set", "world_scale=20", "-o", "-").stdout
    by_option = somo("build", "smallest.yaml", "--scale", "20", "-o", "-").stdout
    both = somo("build", "smallest.yaml", "--set", "world_scale=3", "--scale", "20", "-o", "-")
    assert by_file == by_option == both.stdout
    assert 'size="0.4 0.4 2"' in by_file
    assert somo("build", "smallest.yaml", "-o", "-").stdout != by_file


@pytest.mark.moderate
def test_a_tip_frame_is_one_more_link(somo: Somo, here: Path) -> None:
    without = somo("build", "smallest.yaml", "-o", "-").stdout
    ended = somo("build", "smallest.yaml", "--tip-frame", "hand", "-o", "-")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert '<link name="hand"' in ended.stdout
    assert ended.stdout.count("<link ") == without.count("<link ") + 1


# --- without the engine


@pytest.fixture
def without_engine(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of a machine on which the engine cannot be imported."""
    folder = tmp_path_factory.mktemp("stub")
    (folder / "pybullet.py").write_text("raise ImportError('there is no such engine')\n")
    return {"PYTHONPATH": f"{folder}{os.pathsep}{Path(somo_cli.__file__).parents[1]}"}


@pytest.mark.moderate
def test_without_the_engine_only_a_run_is_refused(
    somo: Somo, here: Path, without_engine: dict[str, str]
) -> None:
    assert somo("check", "scene_everything.yaml", env=without_engine).returncode == 0
    assert somo("build", "shapes.yaml", env=without_engine).returncode == 0
    before = names(here)
    ended = somo("run", "bent.yaml", "--steps", "1", env=without_engine)
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    assert (ended.returncode, ended.stdout) == (5, "")
    assert ended.stderr == (
        f"somo: the engine, PyBullet, is not installed for this Python ({python}); "
        "build and check work without it\n"
    )
    assert names(here) == before


# --- run


@pytest.mark.moderate
def test_a_run_writes_rows_and_what_they_are_about(somo: Somo, here: Path) -> None:
    before = names(here)
    ended = somo("run", "bent.yaml", "--steps", "20", "--set", "record={every: 5}")
    assert (ended.returncode, ended.stdout) == (0, "")
    assert re.fullmatch(r"bent\.csv: 5 rows of 7 columns; 0\.02 s in .*\n", ended.stderr)
    assert names(here) - before == {"bent.csv", "bent.meta.json"}
    rows = columns(here / "bent.csv")
    assert rows["time_s"] == [0.0, 0.005, 0.01, 0.015, 0.02]
    assert rows["arm.actuator_0_joint_01.angle_rad"][-1] != 0
    about = json.loads((here / "bent.meta.json").read_text("utf-8"))
    assert about["columns"] == list(rows)
    assert about["rows"] == 5
    assert about["overrides"] == ["record={every: 5}"]
    assert set(about["inputs"]) == {"bent.yaml", "smallest.yaml"}


@pytest.mark.moderate
def test_a_run_of_no_steps_is_the_start(somo: Somo, here: Path) -> None:
    ended = somo("run", "bent.yaml", "--steps", "0", "-q", "-o", "x.csv")
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    assert columns(here / "x.csv")["time_s"] == [0.0]


@pytest.mark.moderate
def test_every_and_time_step_take_the_place_of_those_in_the_scene(somo: Somo, here: Path) -> None:
    options = ("--every", "3", "--time-step", "0.002")
    assert somo("run", "bent.yaml", "--steps", "10", *options).returncode == 0
    assert columns(here / "bent.csv")["time_s"] == pytest.approx([0.0, 0.006, 0.012, 0.018])
    assert json.loads((here / "bent.meta.json").read_text())["time_step_s"] == 0.002


@pytest.mark.moderate
def test_a_definition_runs_by_itself(somo: Somo, here: Path) -> None:
    assert somo("run", "smallest.yaml", "--steps", "3").returncode == 0
    assert somo("run", "scene_smallest.yaml", "--steps", "3").returncode == 0
    assert (here / "smallest.csv").read_bytes() == (here / "scene_smallest.csv").read_bytes()


@pytest.mark.moderate
def test_a_start_outside_the_limits_is_shown_in_the_definition(somo: Somo, here: Path) -> None:
    text = (here / "smallest.yaml").read_text().replace("[-1, 1, 1, 1]", "[0.5, 1, 1, 1]")
    (here / "off.yaml").write_text(text)
    assert somo("check", "off.yaml").returncode == 0
    ended = somo("run", "off.yaml", "--steps", "3")
    assert ended.returncode == 3
    assert ended.stderr.splitlines()[0] == (
        "off.yaml:1:1: error: joint 'actuator_0_joint_01' starts at 0 rad, outside its limits "
        "[0.5, 1]"
    )


@pytest.mark.moderate
def test_a_scene_with_everything_runs(somo: Somo, here: Path) -> None:
    ended = somo("run", "scene_everything.yaml", "--steps", "20", "-q")
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    rows = columns(here / "scene_everything.csv")
    assert all(math.isfinite(value) for values in rows.values() for value in values)
    assert {name.partition(".")[0] for name in rows} == {"time_s", "left", "right", "last"}


@pytest.mark.moderate
def test_rows_to_standard_output_are_the_file(somo: Somo, here: Path) -> None:
    before = names(here)
    piped = somo("run", "bent.yaml", "--steps", "50", "-q", "-o", "-")
    assert (piped.returncode, piped.stderr) == (0, "")
    assert names(here) == before
    header, *rows = piped.stdout.splitlines()
    assert header.startswith("time_s,arm.")
    assert len(rows) == 51
    assert {row.count(",") for row in rows} == {header.count(",")}
    assert somo("run", "bent.yaml", "--steps", "50", "-q").returncode == 0
    assert (here / "bent.csv").read_text() == piped.stdout


@pytest.fixture
def start(here: Path, environment: dict[str, str]) -> Start:
    """Start the command, to be ended by the test."""

    def started(*arguments: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-m", "somo_cli", *arguments],
            cwd=here,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    return started


@pytest.mark.moderate
@pytest.mark.parametrize(
    "arguments", [("run", "bent.yaml", "--steps", "10000000"), ("build", "most_joints.yaml")]
)
def test_a_reader_that_has_seen_enough_ends_it_quietly(
    start: Start, arguments: tuple[str, ...]
) -> None:
    with start(*arguments, "-o", "-") as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline().startswith(("time_s", "<?xml"))
        process.stdout.close()
        assert process.stderr.read() == ""
        assert process.wait(timeout=30) == 0


@pytest.mark.moderate
def test_an_interrupted_run_keeps_its_rows(start: Start, here: Path) -> None:
    unfinished = here / "x.csv.partial"
    with start("run", "bent.yaml", "--steps", "100000000", "-o", "x.csv") as process:
        deadline = time.monotonic() + 60
        while not unfinished.exists() or unfinished.stat().st_size < 10_000:
            assert time.monotonic() < deadline
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
    assert process.returncode == 130
    assert said == "somo: the rows so far are in x.csv.partial\nsomo: interrupted\n"
    assert not (here / "x.csv").exists()
    assert not (here / "x.meta.json").exists()
    text = unfinished.read_text()
    assert text.endswith("\n")
    assert len({line.count(",") for line in text.splitlines()}) == 1


@pytest.mark.moderate
def test_a_diverged_run_reports_where_and_keeps_its_rows(somo: Somo, here: Path) -> None:
    (here / "x.csv").write_text("old")
    ended = somo("run", "diverging.yaml", "--steps", "10000", "-o", "x.csv")
    plain(ended)
    assert (ended.returncode, ended.stdout) == (4, "")
    kept, said, hint = ended.stderr.splitlines()
    assert kept == "somo: the rows so far are in x.csv.partial"
    match = re.fullmatch(
        r"somo: the simulation diverged at step (\d+) \((.+) s\): "
        r"joint 'arm\.actuator_0_joint_0[123]': .+",
        said,
    )
    assert match
    assert float(match[2]) == pytest.approx(int(match[1]) * 0.05, rel=1e-3)
    assert hint.startswith("  hint: ")
    rows = columns(here / "x.csv.partial")
    assert len(rows["time_s"]) >= 1
    assert rows["time_s"][-1] <= float(match[2]) + 1e-9
    assert all(math.isfinite(value) for values in rows.values() for value in values)
    assert (here / "x.csv").read_text() == "old"
    assert not (here / "x.meta.json").exists()


# --- the same bytes everywhere


def built_and_run_bytes(somo: Somo, folder: Path, **options: object) -> tuple[bytes, bytes]:
    """Return the bytes of a URDF and a CSV that the commands write to `folder`."""
    for arguments in (
        ("build", "shapes.yaml", "-q", "-o", "made.urdf"),
        ("run", "bent.yaml", "-q", "--steps", "300", "--every", "100", "-o", "made.csv"),
    ):
        ended = somo(*arguments, **options)
        assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    return (folder / "made.urdf").read_bytes(), (folder / "made.csv").read_bytes()


@pytest.fixture(scope="session")
def comma_locale(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of a program in which C writes 0,5, as under some graphical shells."""
    folder = tmp_path_factory.mktemp("locale")
    if shutil.which("localedef") is None:
        pytest.skip("there is no localedef to make a locale with")
    command = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")]
    if subprocess.run(command, capture_output=True, check=False).returncode > 1:
        pytest.skip("localedef does not know de_DE")
    (folder / "sitecustomize.py").write_text("import locale\nlocale.setlocale(locale.LC_ALL, '')\n")
    environment = {
        "LOCPATH": str(folder),
        "LC_ALL": "de_DE.UTF-8",
        "PYTHONPATH": f"{folder}{os.pathsep}{Path(somo_cli.__file__).parents[1]}",
    }
    point = "import locale; print(locale.localeconv()['decimal_point'])"
    reported = subprocess.run(
        [sys.executable, "-c", point], env=os.environ | environment, capture_output=True, check=True
    )
    if reported.stdout.strip() != b",":
        pytest.skip("the locale cannot be used")
    return environment


@pytest.mark.moderate
@pytest.mark.parametrize(
    "other",
    [
        {},
        {"PYTHONHASHSEED": "1"},
        {"PYTHONHASHSEED": "4242", "TZ": "Asia/Kathmandu"},
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    ],
    ids=str,
)
def test_another_process_makes_the_same_bytes(
    somo: Somo, here: Path, other: dict[str, str]
) -> None:
    assert built_and_run_bytes(somo, here, env=other) == built_and_run_bytes(
        somo, here, env={"PYTHONHASHSEED": "0"}
    )


@pytest.mark.moderate
def test_another_folder_makes_the_same_bytes(somo: Somo, here: Path) -> None:
    deeper = here / "deeper folder"
    shutil.copytree(here, deeper, ignore=shutil.ignore_patterns("deeper*"))
    assert built_and_run_bytes(somo, deeper, cwd=deeper) == built_and_run_bytes(somo, here)


@pytest.mark.moderate
def test_a_locale_with_commas_makes_the_same_bytes(
    somo: Somo, here: Path, comma_locale: dict[str, str]
) -> None:
    assert built_and_run_bytes(somo, here, env=comma_locale) == built_and_run_bytes(somo, here)


# --- examples


@pytest.mark.moderate
def test_examples_are_copied_and_check(somo: Somo, tmp_path: Path) -> None:
    ended = somo("examples", "copies")
    paths = ended.stdout.split()
    assert (ended.returncode, ended.stderr.splitlines()[0]) == (0, "next:")
    named = re.findall(r"copies/\S+", ended.stderr)
    assert named
    assert all((tmp_path / name).is_file() for name in named)
    assert "copies/definitions/finger.yaml" in paths
    assert somo("check", *paths).returncode == 0
    schema = (tmp_path / paths[0]).read_text().splitlines()[0].rsplit("=", 1)[1]
    assert (tmp_path / "copies" / "definitions" / schema).is_file()
    again = somo("examples", "copies")
    assert (again.returncode, again.stderr) == (5, "somo: copies: File exists\n")


@pytest.mark.moderate
def test_a_device_gets_no_metadata_beside_it(somo: Somo) -> None:
    assert somo("run", VALID / "smallest.yaml", "--steps", 2, "-o", "/dev/null").returncode == 0
    assert not Path("/dev/null.meta.json").exists()
