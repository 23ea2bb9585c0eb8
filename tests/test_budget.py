"""The time and memory that a command may use, and how it ends when they are spent."""

from __future__ import annotations

from pathlib import Path

import pytest

from somo_cli import terminal
from somo_cli.budget import Budget, most_memory
from somo_cli.problems import BudgetSpent
from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS

SCENE = DEFINITIONS / "scene.yaml"


def test_time_counts_from_the_start_and_a_bound_is_allowed() -> None:
    now = [100.0]
    budget = Budget(max_seconds=2.5, clock=lambda: now[0])
    with terminal.progress(9, "working", budget) as advance:
        now[0] = 102.5
        advance(3)
        now[0] = 102.6
        with pytest.raises(BudgetSpent) as caught:
            advance(4)
    assert str(caught.value) == "more than 2.5 s, the most of --max-seconds; working: 4 of 9 done"


def test_memory_is_measured_when_it_is_looked_at() -> None:
    used = [199e6]
    budget = Budget(max_memory=200.0, memory=lambda: used[0])
    budget.check("")
    used[0] = 201e6
    with pytest.raises(BudgetSpent, match=r"^201 MB of memory, more than 200, the most of --max-m"):
        budget.check("")


def test_without_bounds_nothing_is_spent() -> None:
    Budget(clock=lambda: 1e9, memory=lambda: 1e18).check("")


def test_memory_of_this_process_is_in_bytes() -> None:
    before = most_memory()
    kept = bytearray(b"1" * 400_000_000)
    assert 10e6 < before < 4e9
    assert most_memory() > 400e6
    del kept


@pytest.mark.moderate
def test_a_run_that_takes_too_long_keeps_its_rows(somo: Somo, tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("old", "utf-8")
    ended = somo("run", SCENE, "--steps", "90000000", "--max-seconds", "1.5", "-o", "x.csv")
    first, second = ended.stderr.splitlines()
    assert (ended.returncode, first) == (6, "somo: the rows so far are in x.csv.partial")
    assert second.startswith("somo: more than 1.5 s, the most of --max-seconds; simulating: ")
    assert second.endswith(" of 90000000 done")
    assert (tmp_path / "x.csv.partial").read_text("utf-8").endswith("\n")
    assert (tmp_path / "x.csv").read_text("utf-8") == "old"


@pytest.mark.moderate
@pytest.mark.parametrize(
    "arguments",
    [
        ("run", SCENE, "--steps", "9000", "--tolerance", "1e-9"),
        ("run", SCENE, "--steps", "20", "--error", "-o", "x.csv"),
        ("render", SCENE, "--at", "100", "-o", "x.png"),
        ("report", SCENE, "--duration", "100"),
    ],
)
def test_what_needs_more_memory_than_it_may_leaves_nothing(
    somo: Somo, tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    ended = somo(*arguments, "--max-memory", "20")
    assert (ended.returncode, ended.stdout) == (6, "")
    assert " MB of memory, more than 20, the most of --max-memory; " in ended.stderr
    assert [path.name for path in tmp_path.iterdir() if not path.name.endswith(".partial")] == []


@pytest.mark.moderate
def test_a_run_within_its_budget_is_as_without_one(somo: Somo) -> None:
    run = ("run", SCENE, "--steps", "100", "-q", "-o", "-")
    within = somo(*run, "--max-seconds", "3600", "--max-memory", "4e4")
    assert (within.returncode, within.stderr) == (0, "")
    assert within.stdout == somo(*run).stdout
