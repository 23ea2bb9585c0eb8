"""Guard the process against a C library that prints, and that reads numbers by the locale."""

from __future__ import annotations

import ctypes
import locale
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress


@contextmanager
def captured_output() -> Iterator[Callable[[], str]]:
    """Keep what C prints out of standard output and standard error.

    Yields a function that returns what was printed so far, on one line.
    """
    with tempfile.TemporaryFile() as kept:

        def printed() -> str:
            _flush_c()
            kept.seek(0)
            lines = kept.read().decode(errors="replace").splitlines()
            return " ".join(line for line in lines if "build time" not in line)

        with _redirected((1, 2), kept.fileno()):
            yield printed


@contextmanager
def stdout_to_stderr() -> Iterator[None]:
    """Send what C prints on standard output to standard error, where messages go.

    This is for commands, whose results go to standard output: open the results first. A library
    must not redirect the standard output of its user for longer than a call.
    """
    with _redirected((1,), 2):
        yield


@contextmanager
def _redirected(descriptors: tuple[int, ...], target: int) -> Iterator[None]:
    """Redirect the file descriptors that are open to another one, and restore them at the end."""
    duplicates = {descriptor: _duplicate(descriptor) for descriptor in descriptors}
    saved = {key: value for key, value in duplicates.items() if value is not None}
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
        _flush_c()
        with suppress(OSError):  # where the target is closed nothing is redirected
            for descriptor in saved:
                os.dup2(target, descriptor)
        yield
    finally:
        _flush_c()
        for descriptor, original in saved.items():
            os.dup2(original, descriptor)
            os.close(original)


@contextmanager
def decimal_points() -> Iterator[None]:
    """Make C read "." as the decimal point, whatever the locale of the program."""
    own = locale.setlocale(locale.LC_NUMERIC)
    locale.setlocale(locale.LC_NUMERIC, "C")
    try:
        yield
    finally:
        locale.setlocale(locale.LC_NUMERIC, own)


def _duplicate(descriptor: int) -> int | None:
    """Return a copy of an open file descriptor, None for a closed one."""
    try:
        return os.dup(descriptor)
    except OSError:
        return None


def _flush_c() -> None:
    """Empty C's own buffers, so that its text lands where the descriptors point now."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).fflush(None)
