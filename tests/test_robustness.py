"""A few cases of `make signals` and `make faults`, which try every command."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.robustness.commands import COMMANDS
from tests.robustness.faults import Injection, reason_to_skip
from tests.robustness.signals import NAMES, Trial

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")


@pytest.mark.slow
@pytest.mark.parametrize("title", ["build", "run"])
def test_a_signal_at_any_moment_leaves_whole_files(tmp_path: Path, title: str) -> None:
    if COMMANDS[title].uses_engine:
        pytest.importorskip("pybullet")
    trial = Trial(COMMANDS[title], tmp_path)
    for name, share in zip(NAMES, (0.5, 0.7, 0.8, 0.9, 0.95), strict=True):
        end, faults = trial.outcome(name, share * trial.duration)
        assert end != "wrong"
        assert faults == []


@pytest.mark.slow
def test_a_failing_system_call_leaves_whole_files(tmp_path: Path) -> None:
    if reason := reason_to_skip():
        pytest.skip(reason)
    injection = Injection(COMMANDS["build"], tmp_path)
    assert injection.counts["fsync"] > 0 < injection.counts["rename"]
    assert [(*case, *injection.faults(*case)) for case in injection.cases()] == [*injection.cases()]
