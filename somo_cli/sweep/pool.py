"""Worker processes that stay: each runs one set after another, and may die without harm.

A worker that dies, or takes longer than the time-out, is an outcome of its run; another takes its
place. The start-up of Python and of the engine is paid once a worker.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from somo_cli.sweep.one_run import Outcome, StudyRunner
from somo_cli.sweep.study import Point

Task = tuple[int, Point]

_MAX_WAIT = 0.5  # s between two looks at the clock
_READY = "ready"


@dataclass(slots=True)
class _Worker:
    process: BaseProcess
    connection: Connection
    number: int | None = None  # of the run that it is at
    started: float = 0.0  # s: when it began that run
    is_ready: bool = False  # it has loaded its modules


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Pool:
    """Runs tasks in worker processes; to be used by `with`, which ends all of them."""

    def __init__(
        self, runner: StudyRunner, workers: int, time_out: float | None, only_checks: bool = False
    ) -> None:
        self._runner = runner
        self._count = workers
        self._time_out = time_out
        self._only_checks = only_checks
        self._context = multiprocessing.get_context("spawn")
        self._workers: list[_Worker] = []

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            worker.process.join()
            worker.connection.close()

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[int, Outcome]]:
        """Yield the number and the outcome of every task, as they end."""
        waiting = iter(tasks)
        for task in waiting:
            worker = self._start()
            self._workers.append(worker)
            self._send(worker, task)
            if len(self._workers) == self._count:
                break
        while any(worker.number is not None for worker in self._workers):
            for place, outcome in self._ended():
                worker = self._workers[place]
                number = worker.number
                assert number is not None
                worker.number = None
                following = next(waiting, None)
                if following is not None:
                    if not worker.process.is_alive():
                        worker = self._workers[place] = self._start()
                    self._send(worker, following)
                yield number, outcome

    def _start(self) -> _Worker:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(
            target=_work, args=(theirs, self._runner, self._only_checks), daemon=True
        )
        with _interrupts_held():
            process.start()
        theirs.close()
        return _Worker(process, ours)

    def _send(self, worker: _Worker, task: Task) -> None:
        worker.number, worker.started = task[0], time.monotonic()
        worker.connection.send(task)

    def _ended(self) -> list[tuple[int, Outcome]]:
        """Wait for the end of runs; return which workers ended one, and how."""
        busy = [place for place, one in enumerate(self._workers) if one.number is not None]
        # the end of a worker closes its end of the pipe, so that this reports it as well
        ready = set(wait([self._workers[place].connection for place in busy], _MAX_WAIT))
        found = []
        for place in busy:
            worker = self._workers[place]
            if worker.connection in ready:
                outcome = _received(worker)
                if outcome is not None:
                    found.append((place, outcome))
            elif self._is_late(worker):
                worker.process.kill()
                worker.process.join()
                reason = f"it took longer than {self._time_out:g} s"
                found.append((place, Outcome("timed out", reason=reason, log=reason)))
        return found

    def _is_late(self, worker: _Worker) -> bool:
        late = time.monotonic() - worker.started
        return worker.is_ready and self._time_out is not None and late > self._time_out


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Have a process that is started here never be interrupted: its parent ends it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _received(worker: _Worker) -> Outcome | None:
    """Return the outcome that a worker sends or is; None if it has only become ready."""
    try:
        received: Outcome | str = worker.connection.recv()
    except (EOFError, ConnectionError):
        worker.process.join()
        code = worker.process.exitcode
        reason = f"the process ended with {code}"
        if code is not None and code < 0:
            reason = f"the process was ended by signal {-code}"
        return Outcome("crashed", reason=reason, log=reason)
    if isinstance(received, str):
        worker.is_ready, worker.started = True, time.monotonic()
        return None
    return received


def _work(connection: Connection, runner: StudyRunner, only_checks: bool) -> None:
    """Take tasks until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _silence()
    with suppress(BrokenPipeError, ConnectionError):
        connection.send(_READY)
    while True:
        try:
            number, point = connection.recv()
        except (EOFError, ConnectionError):
            return
        outcome = runner.check(point) if only_checks else runner.run(number, point)
        try:
            connection.send(outcome)
        except (BrokenPipeError, ConnectionError):
            return


def _silence() -> None:
    """Drop what the engine prints; errors of a run are in its outcome."""
    null = os.open(os.devnull, os.O_WRONLY)
    for descriptor in (1, 2):
        os.dup2(null, descriptor)
    os.close(null)
