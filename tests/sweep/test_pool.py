"""Workers that die or take too long are outcomes of their runs, and others take their places."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

import pytest

from somo_cli.sweep.one_run import Outcome, StudyRunner
from somo_cli.sweep.pool import Pool


@dataclass(frozen=True)
class FakeRunner:
    """Does what a parameter says."""

    def run(self, number: int, point: Mapping[str, Any]) -> Outcome:
        match point["do"]:
            case "die":
                os.kill(os.getpid(), signal.SIGKILL)
            case "leave":
                os._exit(3)
            case "sleep":
                time.sleep(60)
        return Outcome("done", {"square": number**2})


@pytest.mark.moderate
@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_every_run_has_an_outcome() -> None:
    orders = ["work", "die", "sleep", "work", "leave", "work"]
    runner = cast(StudyRunner, FakeRunner())
    with Pool(runner, 2, time_out=0.5) as pool:
        tasks = [(number, {"do": order}) for number, order in enumerate(orders)]
        found = dict(pool.outcomes(tasks))
        workers = [worker.process for worker in pool._workers]
    assert [found[number].status for number in range(6)] == [
        *("done", "crashed", "timed out", "done", "crashed", "done")
    ]
    assert found[1].reason == "the process was ended by signal 9"
    assert found[4].reason == "the process ended with 3"
    assert found[2].reason == "it took longer than 0.5 s"
    assert [found[number].labels["square"] for number in (0, 3, 5)] == [0, 9, 25]
    assert not any(process.is_alive() for process in workers)


def test_no_tasks_need_no_workers() -> None:
    with Pool(cast(StudyRunner, FakeRunner()), 2, None) as pool:
        assert list(pool.outcomes([])) == []
        assert pool._workers == []
