"""The command in a process of its own: the fixture `somo`, and processes that a test ends."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

Somo = Callable[..., subprocess.CompletedProcess[str]]
"""`somo("check", path, cwd=..., stdin=..., env=..., timeout=...)`; arguments are str or Path."""

SIMULATION = "somo_cli.simulation.session"
"""The module that every command which simulates loads just before it does."""


def start_and_wait_for(
    module: str, arguments: list[str], cwd: Path, environment: dict[str, str]
) -> subprocess.Popen[str]:
    """Start the command; return once it has loaded a module, of which Python reports each."""
    process = subprocess.Popen(
        [sys.executable, "-X", "importtime", "-m", "somo_cli", *arguments],
        cwd=cwd,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )
    give_up = threading.Timer(60.0, process.kill)
    give_up.start()
    assert process.stderr is not None
    loaded = any(line.split("|")[-1].strip() == module for line in process.stderr)
    give_up.cancel()
    assert loaded, f"{module} was not loaded"
    return process


def end_by(process: subprocess.Popen[str], number: int, delay: float = 0.0) -> tuple[int, str, str]:
    """Send a signal after `delay` [s]; return exit code, output and messages.

    What Python reports of loaded modules is left out.
    """
    time.sleep(delay)
    process.send_signal(number)
    output, text = process.communicate(timeout=60)
    lines = text.splitlines(keepends=True)
    return process.returncode, output, "".join(x for x in lines if not x.startswith("import time:"))
