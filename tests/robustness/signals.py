"""Send signals at random moments to every command, and count how each ends.

`make signals`; `python -m tests.robustness.signals COUNT SEED`: COUNT signals for each command.
Ends with 1 if any left half a file, a temporary one, a traceback, or another exit code.
"""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from tests.robustness.commands import (
    COMMANDS,
    Command,
    command_line,
    contents,
    environment,
    faults_of,
    prepare,
    temporary_folder,
)

NAMES = ("SIGINT", "SIGTERM", "SIGHUP", "SIGPIPE", "SIGKILL")
COUNT = 100
PATIENCE = 60.0  # s


class Trial:
    """A command that signals are sent to, beside what it does undisturbed."""

    def __init__(self, command: Command, root: Path) -> None:
        self._command = command
        self._folder = root / "here"
        self._fresh()
        self._before = contents(self._folder)
        started = time.perf_counter()
        with self._start() as process:
            process.communicate(timeout=PATIENCE)
        done = process.returncode
        assert done == command.code, f"{command.arguments} ends with {done}"
        self.duration = time.perf_counter() - started  # s
        self._whole = contents(self._folder)

    def outcome(self, name: str, delay: float) -> tuple[str, list[str]]:
        """Return how the command ends after a signal at `delay` [s], and what is wrong then."""
        self._fresh()
        with self._start() as process:
            time.sleep(delay)
            process.send_signal(signal.Signals[name])
            messages = process.communicate(timeout=PATIENCE)[1].decode()
        end = _end(process.returncode, signal.Signals[name], self._command.code, messages)
        if name == "SIGKILL":
            faults = self._faults_of_another_run()
        else:
            faults = faults_of(self._command, self._before, self._whole, self._folder)
        if end in ("done", "ended") and "Traceback" in messages:
            faults.append("a traceback")
        if end == "wrong":
            faults.append(f"exit code {process.returncode}: {messages[-500:]}")
        return end, faults

    def _faults_of_another_run(self) -> list[str]:
        """Return what is wrong after the command once more, where nothing could be put in order."""
        for path in temporary_folder(self._folder).iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()  # the system's to clean
        with self._start() as process:
            messages = process.communicate(timeout=PATIENCE)[1].decode()
        if process.returncode != self._command.code:
            return [f"then it ends with {process.returncode}: {messages}"]
        return faults_of(self._command, self._before, self._whole, self._folder)

    def _start(self) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            command_line(self._command),
            cwd=self._folder,
            env=environment(self._folder),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )

    def _fresh(self) -> None:
        for folder in (self._folder, temporary_folder(self._folder)):
            shutil.rmtree(folder, ignore_errors=True)
        prepare(self._folder)


def _end(code: int, number: int, right_code: int, messages: str) -> str:
    if code == right_code:
        return "done"
    if code == 128 + number or (number == signal.SIGKILL and code == -number):
        return "ended"
    # before the first line of this program Python ends by itself, with words of its own
    is_early = "somo: " not in messages and "somo_cli/c" not in messages
    return "before it began" if code in (1, -number) and is_early else "wrong"


def main(count: int = COUNT, seed: int = 1, only: str = "") -> int:
    """Return the exit code."""
    chance = random.Random(seed)
    wrong = 0
    with tempfile.TemporaryDirectory() as root:
        for title, command in COMMANDS.items():
            if only and title != only:
                continue
            trial = Trial(command, Path(root))
            ends: Counter[str] = Counter()
            for index in range(count):
                name = NAMES[index % len(NAMES)]
                delay = chance.uniform(0.0, 1.1 * trial.duration)
                end, faults = trial.outcome(name, delay)
                ends[end] += 1
                wrong += bool(faults)
                for fault in faults:
                    print(f"  {title}: {name} at {delay:.3f} s, {end}: {fault}")
            counted = ", ".join(f"{number} {end}" for end, number in ends.most_common())
            print(f"{title:12} {count} signals in {trial.duration:.2f} s: {counted}", flush=True)
    print(f"wrong: {wrong}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:3]), *sys.argv[3:]))
