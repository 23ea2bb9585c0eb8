"""`run --guarded`: a simulation in a process of its own, and what is left if that dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from somo_cli.cli.run_guarded import _keep_whole_rows
from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS

SCENE = DEFINITIONS / "scene.yaml"
CHILDREN = Path("/proc/self/task")

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked")


@pytest.mark.moderate
def test_a_guarded_run_is_as_any_other(somo: Somo, tmp_path: Path) -> None:
    run = ("run", SCENE, "--steps", "100", "-q")
    assert somo(*run, "-o", "a.csv").returncode == 0
    ended = somo(*run, "-o", "b.csv", "--guarded")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    refused = somo("run", SCENE, "--steps", "100", "--guarded", "--max-seconds", "0")
    assert (refused.returncode, refused.stderr.count("the most of --max-seconds")) == (6, 1)


@pytest.mark.moderate
@pytest.mark.skipif(not CHILDREN.exists(), reason="there is no /proc")
@pytest.mark.parametrize("name", ["SIGSEGV", "SIGINT", "SIGTERM"])
def test_what_is_left_of_a_run_that_dies(
    tmp_path: Path, environment: dict[str, str], name: str
) -> None:
    command = ["run", str(SCENE), "--steps", "90000000", "--every", "1", "-o", "x.csv"]
    with subprocess.Popen(
        [sys.executable, "-m", "somo_cli", *command, "--guarded"],
        cwd=tmp_path,
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        partial = tmp_path / "x.csv.partial"
        give_up = time.monotonic() + 60
        while not (partial.exists() and partial.stat().st_size) and time.monotonic() < give_up:
            time.sleep(0.02)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text("utf-8")
        is_fault = name == "SIGSEGV"
        # a signal that asks the command to end goes on to the child
        os.kill(int(children) if is_fault else process.pid, signal.Signals[name])
        _, messages = process.communicate(timeout=60)
    assert not Path(f"/proc/{int(children)}").exists()
    lines = messages.splitlines()
    assert lines[0] == "somo: the rows so far are in x.csv.partial"
    if is_fault:
        assert process.returncode == 4
        assert lines[1] == f"somo: the process that simulated {SCENE} was killed by SIGSEGV"
        assert lines[2].startswith("  hint: a fault of the engine")
    else:
        assert process.returncode == 128 + signal.Signals[name]
    rows = partial.read_text("utf-8")
    assert rows.endswith("\n")
    assert len({row.count(",") for row in rows.splitlines()}) == 1


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("a\n1\n2", "a\n1\n"),
        ("a\n", "a\n"),
        ("a", None),
        ("", None),
        ("x\n" + "1" * 200_000, "x\n"),
    ],
)
def test_unfinished_rows_are_cut(tmp_path: Path, text: str, kept: str | None) -> None:
    path = tmp_path / "x.csv.partial"
    path.write_text(text, "utf-8")
    _keep_whole_rows(str(tmp_path / "x.csv"))
    assert (path.read_text("utf-8") if path.exists() else None) == kept
    _keep_whole_rows("-")
    _keep_whole_rows(str(tmp_path / "other.csv"))


@pytest.mark.moderate
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells of the end of a parent")
def test_the_simulation_ends_with_the_command(tmp_path: Path, environment: dict[str, str]) -> None:
    command = ["run", str(SCENE), "--steps", "90000000", "--every", "1", "-o", "x.csv"]
    process = subprocess.Popen(
        [sys.executable, "-m", "somo_cli", *command, "--guarded"], cwd=tmp_path, env=environment
    )
    partial = tmp_path / "x.csv.partial"
    give_up = time.monotonic() + 60
    while not (partial.exists() and partial.stat().st_size) and time.monotonic() < give_up:
        time.sleep(0.02)
    child = int(Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text("utf-8"))
    process.kill()
    process.wait(timeout=60)
    while _is_running(child) and time.monotonic() < give_up:
        time.sleep(0.02)
    assert not _is_running(child)
    assert partial.read_text("utf-8").endswith("\n")


def _is_running(number: int) -> bool:
    """Return whether a process runs; one that nobody has waited for does not."""
    try:
        state = Path(f"/proc/{number}/stat").read_text("utf-8").rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"
