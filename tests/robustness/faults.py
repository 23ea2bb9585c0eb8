"""Have the n-th system call of every command that writes fail, for every n, and judge what is left.

`make faults`; needs strace, which makes the calls fail. Ends with 1 if a command left half a file
or a temporary one, ended with success though an output is missing, or printed a traceback.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
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

CALLS = {
    "write": "ENOSPC",
    "fsync": "EIO",
    "rename": "EIO",
    "mkdir": "ENOSPC",
    "chmod": "EPERM",
    "ftruncate": "EIO",
    "sendfile": "ENOSPC",
    "copy_file_range": "EIO",
}
"""System calls that write, and the error of each."""

MAX_CALLS = 60
PATIENCE = 120.0  # s


class Injection:
    """A command whose system calls fail, beside what it does undisturbed."""

    def __init__(self, command: Command, root: Path) -> None:
        self._command = command
        self._folder = root / "here"
        self._fresh()
        self._before = contents(self._folder)
        log = root / "calls"
        # --trace needs names that this system may not have: the question mark lets them be
        names = ",".join(f"?{name}" for name in CALLS)
        done = self._run("-f", "-o", str(log), "-e", f"trace={names}")
        assert done.returncode == command.code, done.stderr
        self._whole = contents(self._folder)
        called = re.findall(r"^(?:\d+ +)?(\w+)\(", log.read_text("utf-8", "replace"), re.MULTILINE)
        self.counts = Counter(called)
        """How often the command makes each of these system calls."""

    def cases(self) -> Iterator[tuple[str, int]]:
        """Yield every call, and the number of the one that fails, from 1."""
        for name, count in self.counts.items():
            for number in range(1, min(count, MAX_CALLS) + 1):
                yield name, number

    def faults(self, name: str, number: int) -> list[str]:
        """Return what is wrong when this call fails."""
        self._fresh()
        inject = f"inject={name}:error={CALLS[name]}:when={number}"
        done = self._run("-f", "-o", "/dev/null", "-e", f"trace={name}", "-e", inject)
        faults = faults_of(self._command, self._before, self._whole, self._folder)
        left = contents(self._folder)
        missing = [one for one in self._command.outputs if one in self._whole and one not in left]
        if done.returncode == self._command.code and missing:
            faults.append(f"success without {', '.join(sorted(missing))}")
        if done.returncode not in (self._command.code, 5):
            faults.append(f"exit code {done.returncode}")
        if "Traceback" in done.stderr or "Exception ignored" in done.stderr:
            faults.append(done.stderr[-1000:])
        return faults

    def _run(self, *options: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["strace", "-qq", *options, *command_line(self._command)],
            cwd=self._folder,
            env=environment(self._folder),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            timeout=PATIENCE,
        )

    def _fresh(self) -> None:
        for folder in (self._folder, temporary_folder(self._folder)):
            shutil.rmtree(folder, ignore_errors=True)
        prepare(self._folder)


def reason_to_skip() -> str:
    """Return why no system call can be made to fail here; empty where it can."""
    if shutil.which("strace") is None:
        return "strace is not installed"
    tried = subprocess.run(
        ["strace", "-qq", "-o", "/dev/null", "-e", "inject=fsync:error=EIO:when=1", "true"],
        capture_output=True,
    )
    return "" if tried.returncode == 0 else "strace may not trace processes here"


def main(only: str = "") -> int:
    """Return the exit code."""
    if reason := reason_to_skip():
        print(f"skipped: {reason}")
        return 0
    wrong = 0
    with tempfile.TemporaryDirectory() as root:
        for title, command in COMMANDS.items():
            if only and title != only:
                continue
            injection = Injection(command, Path(root))
            count = 0
            for name, number in injection.cases():
                faults = injection.faults(name, number)
                count += 1
                wrong += bool(faults)
                for fault in faults:
                    print(f"  {title}: {name} {number}: {fault}")
            calls = ", ".join(f"{n} {name}" for name, n in injection.counts.items())
            print(f"{title:12} {count} faults in {calls}", flush=True)
    print(f"wrong: {wrong}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
