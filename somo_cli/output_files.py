"""Write output files: as a whole or not at all; rows of a run one after another."""

from __future__ import annotations

import errno
import os
import secrets
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, TextIO

_STREAMS = ("/dev/stdin", "/dev/stdout", "/dev/stderr", "/dev/fd/", "/proc/")
_NO_FOLLOW = getattr(os, "O_NOFOLLOW", 0)


def write_atomically(path: str, content: str | bytes) -> None:
    """Write a file so that it has its old contents or all of the new ones, never a part.

    Symbolic links are followed, and an existing file keeps its mode. Devices and pipes are written
    directly. Raises OSError.
    """
    written = content.encode("utf-8") if isinstance(content, str) else content
    if is_direct(path):
        with Path(path).open("wb") as device:
            device.write(written)
        return
    target, mode = _resolved_target(path)
    _remove_abandoned(target.parent)
    try:
        temporary, raw = _open_temporary(target.parent)
    except OSError as error:
        raise _with_path(error, path) from error
    try:
        with os.fdopen(raw, "wb") as stream:
            stream.write(written)
            _flush_to_disk(stream)
            # renamed while locked, so that no other run takes it for abandoned
            _move_into_place(temporary, target, mode)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise _with_path(error, path) from error
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


@contextmanager
def open_partial(path: str) -> Iterator[TextIO]:
    """Yield a text stream to `<path>.partial`, which replaces the file at the path in the end.

    After an exception the partial file keeps what was written, and the path its old contents. `-`
    stands for standard output, on a descriptor of its own. Devices and pipes are written directly.
    Raises OSError; BrokenPipeError is one.
    """
    if path == "-":
        if sys.stdout is not None:
            sys.stdout.flush()
        with (
            _named("standard output"),
            _closing(os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")) as stream,
        ):
            yield stream
        return
    if is_direct(path):
        with (
            _named(path),
            _closing(Path(path).open("w", encoding="utf-8", newline="\n")) as stream,
        ):
            yield stream
        return
    target, mode = _resolved_target(path)
    unfinished = target.with_name(target.name + ".partial")
    try:
        raw = _open_locked(unfinished)
    except OSError as error:
        raise _with_path(error, path) from error
    stream = os.fdopen(raw, "w", encoding="utf-8", newline="\n")
    try:
        with _named(path):
            yield stream
            _flush_to_disk(stream)
            # renamed while locked, so that no other run can use the partial file
            _move_into_place(unfinished, target, mode)
    except BaseException:
        with suppress(OSError):
            stream.flush()
        with suppress(OSError):
            if os.fstat(raw).st_size == 0:
                unfinished.unlink()
        with suppress(OSError):
            stream.close()
        raise
    stream.close()


def refuse_unwritable(path: str) -> None:
    """Raise the OSError of `write_atomically` early, before the work whose result it writes."""
    if not is_direct(path):
        folder = _resolved_target(path)[0].parent
        if not folder.is_dir():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
        if not os.access(folder, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)


def is_direct(path: str) -> bool:
    """Return whether a path is a device, a pipe or a stream, so that no file can be beside it."""
    # a file in place of /dev/stdout would not reach the shell that opened it
    if str(Path(path).absolute()).startswith(_STREAMS):
        return True
    try:
        mode = Path(path).stat().st_mode
    except FileNotFoundError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _resolved_target(path: str) -> tuple[Path, int | None]:
    """Return the file behind all symbolic links, and its mode if it exists."""
    target = Path(os.path.realpath(path))
    if path.endswith(os.sep) or target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    try:
        mode = stat.S_IMODE(target.stat().st_mode)
    except FileNotFoundError:
        return target, None
    # renaming over a read-only file is possible, but its owner made it read-only on purpose
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
    return target, mode


def _open_temporary(folder: Path) -> tuple[Path, int]:
    """Return the path and the descriptor of a new file, locked as long as it is written."""
    while True:
        path = folder / f".somo-{secrets.token_hex(8)}.tmp"
        raw = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _NO_FOLLOW, 0o666)
        try:
            # another run may have removed it as abandoned before it was locked here
            with suppress(FileNotFoundError, BlockingIOError):
                _lock(raw)
                if os.path.samestat(os.fstat(raw), path.stat()):
                    return path, raw
        except BaseException:
            os.close(raw)
            path.unlink(missing_ok=True)
            raise
        os.close(raw)


def _remove_abandoned(folder: Path) -> None:
    """Remove the temporary files of runs that were killed: those that nobody has locked."""
    if sys.platform == "win32":
        return
    import fcntl

    for path in folder.glob(".somo-*.tmp"):
        with suppress(OSError):
            raw = os.open(path, os.O_WRONLY | os.O_NONBLOCK | _NO_FOLLOW)
            try:
                fcntl.flock(raw, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if stat.S_ISREG(os.fstat(raw).st_mode):
                    path.unlink()
            finally:
                os.close(raw)


def _open_locked(path: Path) -> int:
    """Return a descriptor of an empty file at a path, locked against other runs.

    The file itself is locked: a separate lock file would outlive a run that is killed.
    """
    flags = os.O_WRONLY | os.O_CREAT | _NO_FOLLOW | getattr(os, "O_NONBLOCK", 0)
    while True:
        raw = os.open(path, flags, 0o666)
        try:
            _lock(raw)
            # another run may have renamed the file after it was opened here
            with suppress(FileNotFoundError):
                found = os.fstat(raw)
                if os.path.samestat(found, path.stat()):
                    if found.st_size:
                        os.ftruncate(raw, 0)
                    return raw
        except BaseException:
            os.close(raw)
            raise
        os.close(raw)


def _lock(raw: int) -> None:
    if sys.platform == "win32":
        return
    import fcntl

    try:
        fcntl.flock(raw, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise BlockingIOError(errno.EBUSY, "another run is writing this file") from error
    except OSError:
        return  # some network file systems have no locks


def _flush_to_disk(stream: TextIO | BinaryIO) -> None:
    stream.flush()
    os.fsync(stream.fileno())


def _move_into_place(finished: Path, target: Path, mode: int | None) -> None:
    if mode is not None:
        finished.chmod(mode)
    finished.replace(target)
    # so that a power cut does not undo the rename; some file systems cannot do this
    with suppress(OSError):
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def _with_path(error: OSError, path: str) -> OSError:
    return OSError(error.errno, error.strerror, path)


@contextmanager
def _named(path: str) -> Iterator[None]:
    """Give an OSError that names no file, such as that of a full disk, the name of this one."""
    try:
        yield
    except OSError as error:
        if error.filename is not None or error.errno is None:
            raise
        raise _with_path(error, path) from error


@contextmanager
def _closing(stream: TextIO) -> Iterator[TextIO]:
    """Yield the stream and close it; an error in closing does not hide an earlier one."""
    try:
        yield stream
        stream.flush()
    except BaseException:
        with suppress(OSError):
            stream.close()
        raise
    stream.close()
