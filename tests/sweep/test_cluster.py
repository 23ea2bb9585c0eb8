"""Sweeps on a Dask cluster: a scheduler and two workers on this machine, of which one is killed."""

from __future__ import annotations

import csv
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")
pytest.importorskip("distributed", reason="distributed is an extra")

STUDY = """\
scene: scene.yaml
duration: 0.4
parameters:
  torque:
    path: "manipulators[0].actuation[0].waypoints[1][1]"
    range: {from: 0.01, to: 0.03, count: 12}
labels:
  reach: {of: finger.tip.z_m, take: last}
keep: torque > 0.0285
"""


@pytest.fixture
def here(tmp_path: Path) -> Path:
    for name in ("finger.yaml", "scene.yaml"):
        shutil.copy(DEFINITIONS / name, tmp_path)
    (tmp_path / "study.yaml").write_text(STUDY, "utf-8")
    return tmp_path


@pytest.fixture
def cluster(
    tmp_path: Path, environment: dict[str, str]
) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Yield the address of a scheduler, and the processes of its two workers."""
    file, started = tmp_path / "scheduler.json", []

    def start(*arguments: str) -> subprocess.Popen[bytes]:
        program = "from distributed.cli import dask_scheduler, dask_worker; import sys; "
        program += f"dask_{arguments[0]}.main(sys.argv[1:])"
        process = subprocess.Popen(
            [sys.executable, "-c", program, "--scheduler-file", str(file), *arguments[1:]],
            cwd=tmp_path,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        started.append(process)
        return process

    start("scheduler", "--port", "0", "--no-dashboard", "--host", "127.0.0.1")
    workers = [
        start("worker", "--no-nanny", "--nthreads", "2", "--no-dashboard", "--host", "127.0.0.1")
        for _ in range(2)
    ]
    from distributed import Client

    give_up = time.monotonic() + 60
    while not file.exists() and time.monotonic() < give_up:
        time.sleep(0.05)
    with Client(scheduler_file=str(file), timeout=60) as client:
        client.wait_for_workers(2, timeout=60)
        address = client.scheduler.address
    try:
        yield address, workers
    finally:
        for process in started:
            process.kill()
            process.wait()


def rows_in(folder: Path) -> list[dict[str, str]]:
    with (folder / "results.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    for row in rows:
        assert float(row.pop("run_time_s")) > 0
    return rows


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_cluster_gives_the_same_table_though_a_worker_is_killed(
    somo: Somo,
    here: Path,
    cluster: tuple[str, list[subprocess.Popen[bytes]]],
    environment: dict[str, str],
) -> None:
    address, workers = cluster
    assert somo("sweep", "study.yaml", "-j", "2", "-q", "-o", "own", cwd=here).returncode == 0
    command = ["sweep", "study.yaml", "--scheduler", address, "-q", "-o", "far"]
    with subprocess.Popen(
        [sys.executable, "-m", "somo_cli", *command],
        cwd=here,
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        journal = here / "far" / "runs.jsonl"
        give_up = time.monotonic() + 60
        while not (journal.exists() and journal.stat().st_size) and time.monotonic() < give_up:
            time.sleep(0.01)
        workers[0].send_signal(signal.SIGKILL)
        _, messages = process.communicate(timeout=120)
    assert process.returncode == 0, messages
    assert rows_in(here / "far") == rows_in(here / "own")
    kept = sorted(path.relative_to(here / "own") for path in (here / "own").rglob("trajectory.csv"))
    assert kept == [Path("0011/trajectory.csv")]
    for path in kept:
        assert (here / "far" / path).read_bytes() == (here / "own" / path).read_bytes()


def test_what_does_not_go_with_a_cluster_is_wrong_usage(somo: Somo, here: Path) -> None:
    ended = somo("sweep", "study.yaml", "--scheduler", "tcp://127.0.0.1:9", "-j", "2", cwd=here)
    assert ended.returncode == 2
    assert "it is for this machine, not a cluster" in " ".join(ended.stderr.split())
    (here / "study.yaml").write_text(STUDY + "time_out: 3\n", "utf-8")
    ended = somo("sweep", "study.yaml", "--scheduler", "tcp://127.0.0.1:9", cwd=here)
    assert ended.returncode == 2
    assert not (here / "study_results").exists()
