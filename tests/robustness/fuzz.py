"""Mutate every shipped file at random, and have `check`, `build` and `run` read it.

`make fuzz`; `python -m tests.robustness.fuzz COUNT SEED SECONDS` for others. Each case has its own
number, from which it is made anew: `python -m tests.robustness.fuzz 1 NUMBER` runs it alone. Cases
run in processes with a bound of memory and time. Ends with 1 if any is wrong.
"""

from __future__ import annotations

import os
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from multiprocessing import Process, SimpleQueue
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

from tests.robustness.documents import Documents, faults_of
from tests.robustness.mutations import mutated

COUNT = 50_000
MAX_SECONDS = 30  # s of a case
MAX_BYTES = 4_000_000_000  # of address space
RUN_SHARE = 0.3  # of the valid scenes that are run as well


class _TooSlow(Exception):
    pass


def outcome(documents: Documents, number: int) -> tuple[str, list[str]]:
    """Return what became of a case, and what is wrong with it."""
    chance = random.Random(number)
    name = chance.choice(sorted(documents.texts))
    text = mutated(chance, documents.texts[name])
    readers = documents.readers_of(name) or [name]
    reader = chance.choice(readers)
    with documents.replaced(name, text):
        code, faults = faults_of("check", reader)
        kind = documents.kind(reader)
        if kind == "definition" and not faults:
            built, faults = faults_of("build", reader, "-q", "-o", "out.urdf")
            if (built == 0) != (code == 0) and not faults:
                faults = [f"check ends with {code}, build with {built}"]
        elif kind == "scene" and code == 0 and not faults and chance.random() < RUN_SHARE:
            _, faults = faults_of("run", reader, "--steps", "16", "-q", "-o", "out.csv")
    return "valid" if code == 0 else "refused", [f"{name}: {fault}" for fault in faults]


def _work(first: int, step: int, until: int, deadline: float, results: Any) -> None:
    """Run every `step`th case in this process, and put the outcome of each in a queue."""
    _bound()
    with tempfile.TemporaryDirectory() as root:
        documents = Documents(Path(root))
        os.chdir(root)
        for number in range(first, until, step):
            if time.time() > deadline:
                break
            results.put((number, "begun", []))
            signal.alarm(MAX_SECONDS)
            try:
                end, faults = outcome(documents, number)
            except _TooSlow:
                end, faults = "slow", [f"takes more than {MAX_SECONDS} s"]
            signal.alarm(0)
            results.put((number, end, faults))
        os.chdir("/")
    results.put((first, "over", []))


def _bound() -> None:
    import resource

    def end(number: int, frame: FrameType | None) -> NoReturn:
        raise _TooSlow

    resource.setrlimit(resource.RLIMIT_AS, (MAX_BYTES, MAX_BYTES))
    signal.signal(signal.SIGALRM, end)
    null = os.open(os.devnull, os.O_WRONLY)  # what the engine prints
    os.dup2(null, 1)
    os.dup2(null, 2)


def main(count: int = COUNT, seed: int = 1, seconds: float = 1e9) -> int:
    """Return the exit code."""
    deadline = time.time() + seconds
    results = SimpleQueue()  # of number, outcome and faults
    workers = os.cpu_count() or 1
    counts: Counter[str] = Counter()
    wrong = 0

    def start(first: int) -> Process:
        arguments = (first, workers, seed + count, deadline, results)
        process = Process(target=_work, args=arguments, daemon=True)
        process.start()
        return process

    processes = {start(seed + index): seed + index for index in range(min(workers, count))}
    current: dict[int, int] = {first % workers: first for first in processes.values()}
    while processes:
        while not results.empty():
            number, end, faults = results.get()
            current[number % workers] = number
            if end not in ("begun", "over"):
                counts[end] += 1
                wrong += bool(faults)
            for fault in faults:
                print(f"  {number} {end}: {fault}", flush=True)
        for process in [one for one in processes if not one.is_alive() and results.empty()]:
            lane = processes.pop(process) % workers
            if process.exitcode:
                wrong += 1
                print(f"  {current[lane]}: the process died with {process.exitcode}", flush=True)
                processes[start(current[lane] + workers)] = current[lane] + workers
        time.sleep(0.05)
    print(f"{sum(counts.values())} cases: " + ", ".join(f"{n} {end}" for end, n in counts.items()))
    print(f"wrong: {wrong}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
