"""Time of whole commands, start of Python included, in seconds: the best of several runs.

Run by `make bench`. Beside the clock's time stands the processor's, which a busy machine disturbs
less. What Python compiles is kept from a first run, as it is where somo is installed. What a
command imports is held by tests/test_imports.py; which imports take how long,
`python -X importtime -m somo_cli ...` prints.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time

from tests.builders.scenes import DEFINITIONS

FINGER, SCENE = str(DEFINITIONS / "finger.yaml"), str(DEFINITIONS / "scene.yaml")
COMMANDS = {
    "(python alone)": [],
    "--version": ["--version"],
    "build finger.yaml": ["build", FINGER],
    "check scene.yaml": ["check", SCENE],
    "run finger.yaml --steps 1": ["run", FINGER, "--steps", "1"],
    "run scene.yaml --steps 1 (cubic waypoints)": ["run", SCENE, "--steps", "1"],
    "calibrate stiffness finger.yaml": ["calibrate", "stiffness", FINGER],
    "check scene.yaml --numerics": ["check", SCENE, "--numerics"],
}


def seconds_of(arguments: list[str], folder: str) -> tuple[float, float]:
    """Return the time of a command by the clock, and that of the processor."""
    program = ["-m", "somo_cli", *arguments] if arguments else ["-c", ""]
    environment = os.environ | {
        "PYTHONPATH": str(DEFINITIONS.parent),
        "PYTHONPYCACHEPREFIX": f"{folder}/compiled",
    }
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    started = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, *program],
        cwd=folder,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - started
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, arguments
    return seconds, used.ru_utime + used.ru_stime


def main() -> None:
    """Print a line for each command."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rounds", type=int, default=10)
    rounds = arguments.parse_args().rounds
    print(f"whole commands, the best of {rounds} runs [s]: clock, processor")
    with tempfile.TemporaryDirectory() as folder:
        for name, command in COMMANDS.items():
            seconds_of(command, folder)
            found = [seconds_of(command, folder) for _ in range(rounds)]
            clock, processor = (min(times) for times in zip(*found, strict=True))
            print(f"  somo {name:45s} {clock:5.2f} {processor:5.2f}", flush=True)


if __name__ == "__main__":
    main()
