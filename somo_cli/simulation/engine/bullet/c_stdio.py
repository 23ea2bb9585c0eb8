"""What a C library does to the process behind Python's back: prints, and reads by the locale."""

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
    """Keep what the engine prints, in C, out of both streams; yield a function that tells it."""
    with tempfile.TemporaryFile() as kept:
        duplicates = {descriptor: duplicate(descriptor) for descriptor in (1, 2)}
        saved = {key: value for key, value in duplicates.items() if value is not None}

        def printed() -> str:
            flush_c()
            kept.seek(0)
            lines = kept.read().decode(errors="replace").splitlines()
            return " ".join(line for line in lines if "build time" not in line)

        try:
            sys.stdout.flush()
            sys.stderr.flush()
            for descriptor in saved:
                os.dup2(kept.fileno(), descriptor)
            yield printed
        finally:
            flush_c()
            for descriptor, original in saved.items():
                os.dup2(original, descriptor)
                os.close(original)


@contextmanager
def decimal_points() -> Iterator[None]:
    """Let C read a decimal point as one, as a program with a comma locale would not."""
    own = locale.setlocale(locale.LC_NUMERIC)
    locale.setlocale(locale.LC_NUMERIC, "C")
    try:
        yield
    finally:
        locale.setlocale(locale.LC_NUMERIC, own)


def duplicate(descriptor: int) -> int | None:
    """Return a copy of an open file descriptor, None for a closed one."""
    try:
        return os.dup(descriptor)
    except OSError:
        return None


def flush_c() -> None:
    """Empty C's own buffers, so that its text lands where the stream points now."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).fflush(None)
