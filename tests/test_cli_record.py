"""What a run records and what ends it, from outside: files, streams, exit codes."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from tests.builders.command import Somo

DEFINITIONS = Path(__file__).parents[1] / "definitions"
LEAVES = "stop=[{object: cube, leaves: {y: [0, 0.05]}}]"
PUSH = ("run", "push_scene.yaml", "--steps", "2000")


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with the shipped scenes, in which the engine is at hand."""
    pytest.importorskip("pybullet")
    shutil.copytree(DEFINITIONS, tmp_path, dirs_exist_ok=True)
    return tmp_path


def table(path: Path) -> tuple[list[str], np.ndarray]:
    header, *lines = path.read_text("utf-8").splitlines()
    return header.split(","), np.array([line.split(",") for line in lines], dtype=float)


@pytest.mark.moderate
def test_a_condition_ends_the_run_and_says_so(somo: Somo, here: Path) -> None:
    assert somo(*PUSH, "-q", "-o", "whole.csv").returncode == 0
    ended = somo(*PUSH, "-o", "stopped.csv", "--set", LEAVES)
    assert (ended.returncode, ended.stdout) == (0, "")
    first, second = ended.stderr.splitlines()
    reason = "'cube' has left y in [0, 0.05]: it is at "
    assert first.startswith("stopped at 1.0")
    assert f" s by stop[0]: {reason}" in first
    assert second.startswith("stopped.csv: ")
    meta = json.loads((here / "stopped.meta.json").read_text("utf-8"))
    assert meta["stopped_by"]["stop"] == 0
    assert meta["stopped_by"]["reason"].startswith(reason)
    names, rows = table(here / "stopped.csv")
    assert meta["rows"] == len(rows)
    assert rows[-1, 0] == pytest.approx(meta["steps"] * 1e-3) == meta["simulated_time_s"]
    assert rows[-1, names.index("cube.pose.y_m")] > 0.05
    # up to there, the run is the one without the condition
    _, whole = table(here / "whole.csv")
    kept = rows[rows[:, 0] <= whole[len(rows) - 2, 0]]
    assert kept.tolist() == whole[: len(kept)].tolist()
    assert json.loads((here / "whole.meta.json").read_text("utf-8"))["stopped_by"] is None


@pytest.mark.moderate
def test_quiet_is_quiet_about_the_end(somo: Somo, here: Path) -> None:
    ended = somo(*PUSH, "-q", "--set", "stop=[{time: 0.01}]")
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    assert len(table(here / "push_scene.csv")[1]) == 2


@pytest.mark.moderate
def test_the_error_is_that_of_the_run_up_to_its_end(somo: Somo, here: Path) -> None:
    # the last row is not one of every tenth
    options = ("--error", "--record", "finger.tip.*", "--record", "cube.pose.q[xw]")
    ended = somo(*PUSH, *options, "--set", "stop=[{time: 0.217}]")
    assert ended.returncode == 0, ended.stderr
    names, rows = table(here / "push_scene.csv")
    assert rows[-1, 0] == 0.217
    error = json.loads((here / "push_scene.meta.json").read_text("utf-8"))["error"]
    assert list(error["columns"]) == names[1:]
    assert 0 < error["columns"]["finger.tip.y_m"]["max"] < 1e-3


@pytest.mark.moderate
def test_columns_by_pattern(somo: Somo, here: Path) -> None:
    assert somo("run", "finger.yaml", "--steps", "3", "--record", "*.tip.z_m").returncode == 0
    assert table(here / "finger.csv")[0] == ["time_s", "finger.tip.z_m"]
    ended = somo("run", "finger.yaml", "--steps", "3", "--record", "finger.tip.w_m")
    assert ended.returncode == 2
    assert "no column matches 'finger.tip.w_m'; did you mean 'finger.tip." in ended.stderr


@pytest.mark.moderate
def test_events_beside_the_rows(somo: Somo, here: Path) -> None:
    ended = somo(*PUSH, "--events", "touches.csv", "-o", "rows.csv")
    assert ended.returncode == 0
    header, *events = (here / "touches.csv").read_text("utf-8").splitlines()
    assert header.startswith("time_s,event,first,first_link,second,second_link,x_m")
    assert ended.stderr.splitlines()[-1] == f"touches.csv: {len(events)} events"
    meta = json.loads((here / "rows.meta.json").read_text("utf-8"))
    assert meta["events"] == len(events) >= 2
    assert somo(*PUSH, "-q").returncode == 0
    assert (here / "rows.csv").read_bytes() == (here / "push_scene.csv").read_bytes()
    # to standard output, or where the scene wants them
    piped = somo(*PUSH, "-q", "--events", "-")
    assert piped.stdout == (here / "touches.csv").read_text("utf-8")
    assert somo(*PUSH, "-q", "--set", "record.events=true").returncode == 0
    assert (here / "push_scene.events.csv").read_text("utf-8") == piped.stdout


@pytest.mark.moderate
@pytest.mark.parametrize("option", [("--events", "e.csv"), ("--record", "*.contact.*")])
def test_the_ground_is_ambiguous_beside_an_object_of_its_name(
    somo: Somo, here: Path, option: tuple[str, str]
) -> None:
    named = ("--set", "objects[0].name=ground")
    assert somo("run", "push_scene.yaml", "--steps", "3", *named).returncode == 0
    ended = somo("run", "push_scene.yaml", "--steps", "3", *named, *option)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "a manipulator or object is called ground" in " ".join(ended.stderr.split())


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--set", "record.events=true", "-o", "-"), "name a file for the events"),
        (("--events", "a.csv", "-o", "./a.csv"), "a.csv would be written twice"),
        (("--events", "-", "-o", "-"), "- is the output of the rows"),
        (("--events", "A.CSV", "-o", "a.csv"), "A.CSV would be written twice"),
        (("--events", "a.csv.partial", "-o", "a.csv"), "a.csv.partial would be written twice"),
        (("--events", "a.meta.json", "-o", "a.csv"), "a.meta.json would be written twice"),
        (("--events", "a", "-o", "a.partial"), "a.partial would be written twice"),
        (("--events", "finger.yaml"), "finger.yaml is one of the files that are read"),
    ],
)
def test_events_that_have_no_place(
    somo: Somo, here: Path, options: tuple[str, ...], message: str
) -> None:
    ended = somo("run", "push_scene.yaml", "--steps", "3", *options)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "'--events'" in ended.stderr
    assert message in " ".join(ended.stderr.split())
    assert not list(here.glob("*.csv"))


@pytest.mark.moderate
def test_both_files_stay_partial_when_a_run_fails(somo: Somo, here: Path) -> None:
    ended = somo(
        *PUSH, "--events", "e.csv", "-o", "r.csv",
        "--set", "integrator=explicit", "--set", "time_step=0.02", "--set", "record.every=1",
    )  # fmt: skip
    assert ended.returncode == 4
    assert sorted(path.name for path in here.glob("?.csv*")) == ["e.csv.partial", "r.csv.partial"]
    for name in ("r.csv", "e.csv"):
        assert f"somo: the rows so far are in {name}.partial" in ended.stderr.splitlines()


@pytest.mark.moderate
def test_a_report_goes_to_the_end_of_its_own_time(somo: Somo, here: Path) -> None:
    options = ("--time-steps", "0.002,0.004", "--duration", "0.1", "--integrators", "implicit")
    reported = []
    for sets in ((), ("--set", "stop=[{time: 0.01}]", "--set", "record.only=['*.tip.x_m']")):
        ended = somo("report", "scene.yaml", *options, *sets, "-o", f"report_{len(reported)}", "-q")
        assert ended.returncode == 0, ended.stderr
        found = json.loads((here / f"report_{len(reported)}" / "report.json").read_text("utf-8"))
        reported.append([case["steps"] for case in found["cases"]])
    assert reported[0] == reported[1]
