"""The workflow and the job script of the manual do what the page says, in a shell."""

from __future__ import annotations

import csv
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from somo_cli.manual import topics
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")

BASH = shutil.which("bash")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(BASH is None, reason="the scripts are for bash"),
]
PAGE = topics.page("scripts")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


@pytest.fixture
def shell_environment(tmp_path: Path, environment: dict[str, str]) -> dict[str, str]:
    """An environment in which `somo` is the command under test."""
    folder = tmp_path / "bin"
    folder.mkdir()
    command = folder / "somo"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m somo_cli "$@"\n', "utf-8")
    command.chmod(0o755)
    return {**environment, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def run(script: str, folder: Path, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    assert BASH is not None
    return subprocess.run(
        [BASH, "-e", "-c", script],
        cwd=folder,
        env=environment,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )


@pytest.mark.skipif(shutil.which("jq") is None, reason="the workflow needs jq")
def test_the_workflow_annotates_and_runs(tmp_path: Path, shell_environment: dict[str, str]) -> None:
    (workflow,) = blocks("yaml")
    named = {one.get("name"): one for one in yaml.safe_load(workflow)["jobs"]["scenes"]["steps"]}
    check, simulate = named["Check every file"]["run"], named["Run a scene"]["run"]
    scenes = tmp_path / "scenes"
    shutil.copytree(DEFINITIONS, scenes)
    ended = run(check, tmp_path, shell_environment)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")
    ended = run(simulate, tmp_path, shell_environment)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert (tmp_path / "lift.csv").stat().st_size > 0
    finger = scenes / "finger.yaml"
    broken = re.sub(
        r"(?m)^( +)spring_stiffness:", r"\1sprng 50%:", finger.read_text("utf-8"), count=1
    )
    (scenes / "a,b.yaml").write_text(broken, "utf-8")
    ended = run(check, tmp_path, shell_environment)
    assert ended.returncode == 1
    wanted = r"::error file=scenes/a%2Cb\.yaml,line=\d+,col=\d+,title=document::unknown key "
    wanted += r"'sprng 50%25'%0A"
    assert any(re.match(wanted, line) for line in ended.stdout.splitlines())


def test_the_jobs_of_an_array_do_a_sweep_together(
    tmp_path: Path, shell_environment: dict[str, str]
) -> None:
    job, merge = blocks("bash")
    shutil.copytree(DEFINITIONS, tmp_path, dirs_exist_ok=True)
    study = (tmp_path / "grasp_study.yaml").read_text("utf-8")
    short = re.sub("count: 4", "count: 2", study).replace("duration: 1.5", "duration: 0.02")
    short = re.sub(r"values: \[0\.005.*?\]", "values: [0.01]", short)
    (tmp_path / "grasp_study.yaml").write_text(short.replace("after: 1.3", "after: 0.01"), "utf-8")
    for task in ("1", "2"):
        array = {"SLURM_ARRAY_TASK_ID": task, "SLURM_ARRAY_TASK_COUNT": "2"}
        slurm = {**shell_environment, **array, "SLURM_CPUS_PER_TASK": "2"}
        for _ in range(2):  # a job that is submitted again has nothing left to do
            ended = run(job, tmp_path, slurm)
            assert ended.returncode == 0, ended.stderr
            assert "2 runs: 2 done, 2 missing" in ended.stderr
    ended = run(merge, tmp_path, shell_environment)
    assert ended.returncode == 0, ended.stderr
    with (tmp_path / "grasps" / "results.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["status"] for row in rows] == ["done"] * 4
