"""somo run --guarded: the run in a process of its own, whose death is reported."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from pathlib import Path
from types import FrameType

import typer

from somo_cli import terminal
from somo_cli.cli.application import require
from somo_cli.cli.run_outputs import Targets

_FORWARDED = ("SIGINT", "SIGTERM", "SIGHUP")
_BLOCK = 1 << 16  # bytes
_PR_SET_PDEATHSIG = 1  # of linux/prctl.h


def go_on_in_child(scene: str, targets: Targets) -> None:
    """Return in a child process; exit here with the child's exit code when it is over.

    If the child is killed, as by a fault of the engine, whole rows stay in `.partial` and the exit
    code is 4. Signals go on to the child, which has a group of its own: from a terminal it would
    get them twice. To be called before the engine is loaded and outputs are opened.
    """
    require(hasattr(os, "fork"), "--guarded", "this system cannot fork processes")
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    numbers = {getattr(signal, name) for name in _FORWARDED}
    # a signal that comes before it can go on to the child waits
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    parent = os.getpid()
    child = os.fork()
    if child == 0:
        os.setpgid(0, 0)
        _end_with(parent)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        return

    def forward(number: int, frame: FrameType | None) -> None:
        with suppress(ProcessLookupError):
            os.kill(child, number)

    for number in numbers:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, forward)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if code >= 0:
        raise typer.Exit(code)
    for target in targets:
        _keep_whole_rows(target)
    cause = signal.Signals(-code).name
    terminal.print_message(f"somo: the process that simulated {scene} was killed by {cause}")
    terminal.print_message(f"  hint: {_hint(cause)}")
    raise typer.Exit(4)


def _end_with(parent: int) -> None:
    """Have this process get SIGTERM when its parent is gone, whatever ended that; on Linux."""
    if sys.platform == "linux":
        # loading ctypes takes milliseconds, which only this command pays
        import ctypes

        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != parent:  # it was gone before
            os.kill(os.getpid(), signal.SIGTERM)


def _hint(cause: str) -> str:
    if cause == "SIGKILL":
        return "by the system, if memory was short; --max-memory ends a run before that"
    return "a fault of the engine: try a smaller time step, or other sizes of what touches"


def _keep_whole_rows(target: str | None) -> None:
    """Cut an unfinished file behind its last whole row and print its path; remove an empty one."""
    if target in (None, "-"):
        return
    path = Path(f"{target}.partial")
    with suppress(FileNotFoundError):
        with path.open("r+b") as stream:
            size = _end_of_last_line(stream.seek(0, os.SEEK_END), stream.fileno())
            stream.truncate(size)
        if size:
            terminal.print_message(f"somo: the rows so far are in {path}")
        else:
            path.unlink()


def _end_of_last_line(size: int, descriptor: int) -> int:
    while size > 0:
        start = max(0, size - _BLOCK)
        found = os.pread(descriptor, size - start, start).rfind(b"\n")
        if found >= 0:
            return start + found + 1
        size = start
    return 0
