"""Time of whole commands, start of Python included: medians of several runs, in seconds.

Run by `make bench`.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.loading import DEFINITIONS

RUNS = 9


def seconds_of(arguments: list[str], folder: str) -> float:
    """Return the median time of a command."""
    times = []
    for _ in range(RUNS):
        started = time.perf_counter()
        command = [str(Path(sys.executable).with_name("somo")), *arguments]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def main() -> None:
    """Print a line for each command."""
    finger, scene = str(DEFINITIONS / "finger.yaml"), str(DEFINITIONS / "scene.yaml")
    print(f"whole commands, medians of {RUNS} runs")
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments in {
            "--version": ["--version"],
            "build finger.yaml": ["build", finger],
            "check scene.yaml": ["check", scene],
            "run finger.yaml --steps 0": ["run", finger, "--steps", "0"],
            "run scene.yaml --steps 0 (cubic way-points)": ["run", scene, "--steps", "0"],
        }.items():
            print(f"  somo {name:45s} {seconds_of(arguments, folder):5.2f} s")


if __name__ == "__main__":
    main()
