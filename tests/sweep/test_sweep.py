"""Sweeps from a study to a table, as a shell sees them."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")

STUDY = """\
scene: scene.yaml
duration: 0.05
parameters:
  segments: {path: "definition(finger.yaml).actuator_definitions[0].n_segments", values: [8, 10]}
  torque: {path: "manipulators[0].actuation[0].waypoints[1][1]", values: [0.01, 0.02]}
  length:
    path: "definition(finger.yaml).actuator_definitions[0].actuator_length"
    expression: 0.01 * segments
labels:
  reach: {of: finger.tip.z_m, take: last}
  bend: {of: finger.tip.y_m}
  end: {of: time_s, take: last}
  is_short: reach < 0.09
  most: max(bend) - min(bend)
"""


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with a finger, its scene and a study of four short runs."""
    for name in ("finger.yaml", "scene.yaml"):
        shutil.copy(DEFINITIONS / name, tmp_path)
    (tmp_path / "study.yaml").write_text(STUDY, "utf-8")
    return tmp_path


def table(folder: Path, without_times: bool = True) -> list[dict[str, str]]:
    with (folder / "results.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    for row in rows:
        run_time = row.pop("run_time_s") if without_times else ""
        assert run_time == "" or float(run_time) > 0
    return rows


@pytest.mark.moderate
def test_a_study_is_one_table_whatever_the_number_of_workers(somo: Somo, here: Path) -> None:
    ended = somo("sweep", "study.yaml", "-j", "2", cwd=here)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout == ""
    assert ended.stderr == "study_results/results.csv: 4 runs: 4 done\n"
    rows = table(here / "study_results")
    assert list(rows[0]) == [
        *("run", "segments", "torque", "length", "reach", "end", "is_short", "most"),
        *("status", "findings", "reason"),
    ]
    assert [row["segments"] for row in rows] == ["8", "8", "10", "10"]
    assert [row["length"] for row in rows] == ["0.08", "0.08", "0.1", "0.1"]
    assert {row["end"] for row in rows} == {"0.05"}
    assert [row["is_short"] for row in rows] == ["true", "true", "false", "false"]
    assert float(rows[1]["most"]) > float(rows[0]["most"]) > 0
    assert sorted(path.name for path in (here / "study_results").iterdir()) == [
        *("results.csv", "runs.jsonl", "study.json")
    ]
    about = json.loads((here / "study_results" / "study.json").read_text("utf-8"))
    assert about["runs"] == 4
    assert about["labels"][:2] == [{"name": "reach", "unit": "m"}, {"name": "end", "unit": "s"}]
    assert set(about["identity"]["inputs"]) == {"scene.yaml", "finger.yaml"}
    assert somo("sweep", "study.yaml", "-j", "1", "-o", "one", "-q", cwd=here).returncode == 0
    assert table(here / "one") == rows
    # a run of the table is what somo run makes of the same values
    finger = "manipulators[0].definition.actuator_definitions[0]"
    run = ("run", "scene.yaml", "--steps", "50", "--every", "1", "-q", "-o", "-")
    sets = (
        f"{finger}.n_segments=8",
        f"{finger}.actuator_length=0.08",
        "manipulators[0].actuation[0].waypoints[1][1]=0.02",
    )
    same = somo(*run, *(part for one in sets for part in ("--set", one)), cwd=here)
    last = list(csv.DictReader(same.stdout.splitlines()))[-1]
    assert last["finger.tip.z_m"] == rows[1]["reach"]


@pytest.mark.moderate
def test_failures_are_rows_and_can_be_done_again(somo: Somo, here: Path) -> None:
    text = STUDY.replace("values: [8, 10]", "values: [10, -1]").replace(
        "  length:", "  law: {path: integrator, values: [implicit, explicit]}\n  length:"
    )
    text = text.replace("duration: 0.05", "duration: 0.05\nkeep: reach > 0.05")
    (here / "study.yaml").write_text(text, "utf-8")
    ended = somo("sweep", "study.yaml", cwd=here)
    assert ended.returncode == 1
    assert ended.stderr == ("study_results/results.csv: 8 runs: 2 diverged, 2 done, 4 invalid\n")
    folder = here / "study_results"
    rows = table(folder)
    assert [row["status"] for row in rows] == ["done", "diverged"] * 2 + ["invalid"] * 4
    assert rows[4]["reason"] == "-1 must be at least 1"
    log = (folder / "0004" / "log.txt").read_text("utf-8")
    assert log.count("error: -") == 2  # the number and the length, each at its place
    assert [row["reach"] for row in rows[4:]] == [""] * 4
    assert sorted(path.name for path in (folder / "0000").iterdir()) == [
        *("trajectory.csv", "trajectory.meta.json")
    ]
    before = (folder / "results.csv").read_bytes()
    again = somo("sweep", "study.yaml", "--resume", cwd=here)
    assert (again.returncode, (folder / "results.csv").read_bytes()) == (1, before)
    retried = somo("sweep", "study.yaml", "--resume", "--retry-failed", "-q", cwd=here)
    assert (retried.returncode, table(folder)) == (1, rows)
    checked = somo("sweep", "study.yaml", "--dry-run", cwd=here)
    assert checked.returncode == 1
    assert checked.stdout.splitlines()[-1] == "8 runs, 4 of them invalid"
    first = "4: segments=-1, torque=0.01, law=implicit, length=-0.01: -1 must be at least 1"
    assert checked.stdout.splitlines()[0] == first


@pytest.mark.moderate
def test_a_file_may_vary_and_a_column_may_be_missing(somo: Somo, here: Path) -> None:
    text = STUDY.replace(
        "labels:",
        """  name: {path: "manipulators[0].name", values: [finger, thumb]}
  which: {path: "manipulators[0].definition", values: [finger.yaml, nothing.yaml]}
labels:""",
    )
    text = text.replace("values: [8, 10]", "values: [10]").replace(
        "values: [0.01, 0.02]", "values: [0.01]"
    )
    (here / "study.yaml").write_text(
        text.replace('"definition(finger.yaml).', '"').replace(
            '"actuator_definitions', '"manipulators[0].definition.actuator_definitions'
        ),
        "utf-8",
    )
    somo("sweep", "study.yaml", "-q", cwd=here)
    rows = table(here / "study_results")
    assert [row["status"] for row in rows] == ["done", "invalid", "invalid", "invalid"]
    assert rows[1]["reason"].startswith("cannot read 'nothing.yaml'")
    assert rows[2]["reason"].startswith("no column matches 'finger.tip.")


@pytest.mark.moderate
def test_a_killed_sweep_goes_on_with_the_same_table(
    somo: Somo, here: Path, environment: dict[str, str]
) -> None:
    whole = somo("sweep", "study.yaml", "-o", "whole", "-q", "-j", "2", cwd=here)
    assert whole.returncode == 0, whole.stderr
    command = [sys.executable, "-m", "somo_cli", "sweep", "study.yaml", "-j", "1", "-q"]
    with subprocess.Popen(command, cwd=here, env=environment) as process:
        journal = here / "study_results" / "runs.jsonl"
        give_up = time.monotonic() + 60
        while not (journal.exists() and journal.stat().st_size) and time.monotonic() < give_up:
            time.sleep(0.005)
        process.kill()
    journal.write_text(journal.read_text("utf-8") + '{"run": 2, "status": "do', "utf-8")
    refused = somo("sweep", "study.yaml", cwd=here)
    assert refused.returncode == 3
    assert "study_results has results already: go on with --resume" in refused.stderr
    ended = somo("sweep", "study.yaml", "--resume", cwd=here)
    assert ended.returncode == 0, ended.stderr
    assert table(here / "study_results") == table(here / "whole")


@pytest.mark.moderate
def test_a_changed_study_is_refused_with_what_changed(somo: Somo, here: Path) -> None:
    assert somo("sweep", "study.yaml", "-q", cwd=here).returncode == 0
    (here / "study.yaml").write_text("# a comment\n" + STUDY, "utf-8")
    assert somo("sweep", "study.yaml", "-q", "--resume", cwd=here).returncode == 0
    (here / "study.yaml").write_text(STUDY.replace("0.05", "0.06"), "utf-8")
    finger = here / "finger.yaml"
    finger.write_text(finger.read_text("utf-8") + "# changed\n", "utf-8")
    refused = somo("sweep", "study.yaml", "--resume", cwd=here)
    assert refused.returncode == 3
    assert refused.stderr == (
        "somo: study_results has results of another study: study: duration changed, "
        "inputs: finger.yaml changed\n"
    )


@pytest.mark.moderate
def test_parts_of_a_sweep_are_merged_to_its_table(somo: Somo, here: Path) -> None:
    assert somo("sweep", "study.yaml", "-o", "whole", "-q", cwd=here).returncode == 0
    for part in ("1", "2"):
        ended = somo("sweep", "study.yaml", "--shard", f"{part}/2", "-o", f"p{part}", cwd=here)
        assert ended.stderr == f"p{part}/results.csv: 2 runs: 2 done, 2 missing\n"
    merged = somo("sweep", "study.yaml", "--merge", "p1", "--merge", "p2", "-o", "all", cwd=here)
    assert (merged.returncode, merged.stderr) == (0, "all/results.csv: 4 runs: 4 done\n")
    assert table(here / "all") == table(here / "whole")
    best = somo(
        *("sweep", "study.yaml", "--resume", "-o", "all", "-q", "--best", "reach"),
        *("--where", "not is_short"),
        cwd=here,
    )
    header, *lines = (line.split() for line in best.stdout.splitlines())
    assert header == ["run", "segments", "torque", "length", "reach", "end", "is_short", "most"]
    assert [line[0] for line in lines] == ["2", "3"]


@pytest.mark.moderate
@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_an_interrupted_sweep_says_how_it_goes_on(here: Path, environment: dict[str, str]) -> None:
    (here / "study.yaml").write_text(STUDY.replace("0.05", "500"), "utf-8")
    command = [sys.executable, "-m", "somo_cli", "sweep", "study.yaml", "-j", "2"]
    with subprocess.Popen(
        command, cwd=here, env=environment, stderr=subprocess.PIPE, text=True
    ) as process:
        give_up = time.monotonic() + 60
        while not (here / "study_results").exists() and time.monotonic() < give_up:
            time.sleep(0.01)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        _, messages = process.communicate(timeout=60)
    assert process.returncode == 130
    assert messages == ("somo: study_results has 0 runs; go on with --resume\nsomo: interrupted\n")
    assert (here / "study_results" / "results.csv").read_text("utf-8").startswith("run,segments,")


@pytest.mark.moderate
def test_wrong_usage_and_inputs_that_would_be_replaced(somo: Somo, here: Path) -> None:
    for options, message in (
        (("--retry-failed",), "it is for --resume"),
        (("--where", "a"), "it is for --best"),
        (("--shard", "3/2"), "'3/2' is not like 1/4"),
    ):
        ended = somo("sweep", "study.yaml", *options, cwd=here)
        assert ended.returncode == 2
        assert message in ended.stderr
    (here / "results.csv").write_text("segments,torque\n8,0.02\n", "utf-8")
    text = STUDY.replace("labels:", "combine: {table: results.csv}\nlabels:")
    text = text.replace(", values: [8, 10]", "").replace(", values: [0.01, 0.02]", "")
    (here / "study.yaml").write_text(text, "utf-8")
    ended = somo("sweep", "study.yaml", "-o", ".", cwd=here)
    assert ended.returncode == 2
    assert "results.csv is one of the files that are read" in " ".join(ended.stderr.split())
    assert somo("sweep", "study.yaml", "-q", cwd=here).returncode == 0
    assert [row["length"] for row in table(here / "study_results")] == ["0.08"]


@pytest.mark.moderate
def test_errors_are_what_half_the_step_changes(somo: Somo, here: Path) -> None:
    coarse = STUDY.replace("duration: 0.05", "duration: 0.2\nerror: true")
    (here / "study.yaml").write_text(coarse, "utf-8")
    ended = somo("sweep", "study.yaml", "-j", "1", "--set", "time_step=4e-3", cwd=here)
    assert ended.returncode == 0, ended.stderr
    rows = table(here / "study_results")
    assert list(rows[0])[4:12] == [
        *("reach", "end", "is_short", "most"),
        *("reach_error", "end_error", "is_short_error", "most_error"),
    ]
    (here / "study.yaml").write_text(coarse.replace("\nerror: true", ""), "utf-8")
    finer = ("--set", "time_step=2e-3", "--set", "record.every=20", "-o", "finer")
    assert somo("sweep", "study.yaml", "-j", "1", *finer, cwd=here).returncode == 0
    for row, half in zip(rows, table(here / "finer"), strict=True):
        assert float(row["most_error"]) == abs(float(row["most"]) - float(half["most"])) > 0
        assert (row["is_short_error"], row["end_error"]) == ("false", "0.0")


@pytest.mark.moderate
def test_warnings_about_the_scene_are_said_once(somo: Somo, here: Path) -> None:
    load = "    loads: [{link: tip, force: [0, 0, 0]}]\n"
    scene = (here / "scene.yaml").read_text("utf-8")
    place = scene.index("    actuation:")
    (here / "scene.yaml").write_text(scene[:place] + load + scene[place:], "utf-8")
    swept = somo("sweep", "study.yaml", "--dry-run", cwd=here)
    checked = somo("check", "study.yaml", cwd=here)
    assert (swept.returncode, checked.returncode) == (0, 0)
    for told in (swept.stderr, checked.stderr):
        assert told.count("warning: this load is zero at all times") == told.count("warning:") == 1
    assert somo("check", "--strict", "study.yaml", cwd=here).returncode == 1
