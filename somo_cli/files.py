"""Files read and written, whole or not at all; the only place files are known."""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, TextIO

from somo_cli.problems import LINE_BREAK, MAX_TEXT_BYTES, InvalidFile, Problem, Span

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")
_STREAMS = ("/dev/stdin", "/dev/stdout", "/dev/stderr", "/dev/fd/", "/proc/")
_NO_FOLLOW = getattr(os, "O_NOFOLLOW", 0)


def read_text(path: str, largest: int = MAX_TEXT_BYTES) -> str:
    """Return the text of a UTF-8 file of at most `largest` bytes, without its byte order mark.

    Raises OSError, or InvalidFile for a file that is too large or in another encoding.
    """
    return _read(Path(path), path, largest)


def open_reference(
    naming_source: str,
    reference: str,
    is_outside_allowed: bool = False,
    root: str | None = None,
    largest: int = MAX_TEXT_BYTES,
    is_binary: bool = False,
) -> tuple[str, str]:
    """Read a file that another file names, relative to that one; return its source and text.

    Raises ValueError for a reference that leaves the folder of the naming file, and that of the
    file `root` if there is one, unless that is allowed; OSError, and InvalidFile as `read_text`
    does. The bytes of a binary file that are not UTF-8 become surrogates.
    """
    if not reference or not reference.isprintable():
        raise ValueError("not the name of a file")
    if _SCHEME.match(reference):
        raise ValueError("a URL or a drive is not allowed, only a path in the same folder")
    if reference.startswith(("/", "\\", "~")) and not is_outside_allowed:
        raise ValueError("the path must be relative to the file that names it")
    folder = Path(naming_source).parent
    path = folder / reference
    real = Path(os.path.realpath(path))
    roots = [folder] if root is None else [folder, Path(root).parent]
    is_inside = any(real.is_relative_to(os.path.realpath(one)) for one in roots)
    if not is_inside and not is_outside_allowed:
        raise ValueError(f"the path leads out of the folder '{roots[-1]}'")
    if real.exists() and not real.is_file():
        raise ValueError("not a regular file")
    return str(path), _read(real, str(path), largest, is_binary)


def write_atomically(path: str, content: str | bytes) -> None:
    """Write a file such that it has the old contents or all of the new, never a part.

    A symbolic link is followed, the mode of an existing file is kept; devices and pipes are
    written directly. Raises OSError.
    """
    written = content.encode("utf-8") if isinstance(content, str) else content
    if is_direct(path):
        with Path(path).open("wb") as device:
            device.write(written)
        return
    target, mode = _resolved_target(path)
    temporary = target.with_name(f".somo-{secrets.token_hex(8)}.tmp")
    try:
        stream = os.fdopen(
            os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _NO_FOLLOW, 0o666), "wb"
        )
    except OSError as error:
        raise _with_path(error, path) from error
    try:
        with stream:
            stream.write(written)
            _flush_to_disk(stream)
        _move_into_place(temporary, target, mode)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise _with_path(error, path) from error
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def relative_path(path: str, other: str) -> str:
    """Return a path as the file `other` would name it, with slashes; whole if on another drive."""
    folder = os.path.realpath(Path(other).parent)
    try:
        return Path(os.path.relpath(os.path.realpath(path), folder)).as_posix()
    except ValueError:
        return Path(path).absolute().as_posix()


def refuse_unwritable(path: str) -> None:
    """Raise OSError, before long work, where `write_atomically` would raise it after."""
    if not is_direct(path):
        folder = _resolved_target(path)[0].parent
        if not folder.is_dir():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
        if not os.access(folder, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)


def copy_examples(folder: str) -> list[str]:
    """Copy the shipped definitions, and the schemas they name, into a new folder.

    Returns the paths of the definitions. Raises OSError, also if the folder exists.
    """
    here = Path(__file__).parent
    shipped = here if (here / "definitions").is_dir() else here.parent  # wheel, else checkout
    target = Path(folder)
    target.mkdir(parents=True)
    for part in ("definitions", "schemas"):
        shutil.copytree(shipped / part, target / part)
    return sorted(str(path) for path in (target / "definitions").glob("*.yaml"))


def open_standard_streams() -> None:
    """Put the null device where the shell closed a standard stream.

    Otherwise the next file to be opened would take its number, and receive what others print.
    """
    for descriptor, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
        if getattr(sys, name) is None:
            stream = Path(os.devnull).open(mode, encoding="utf-8")  # noqa: SIM115  # for good
            setattr(sys, name, stream)


@contextmanager
def temporary_file() -> Iterator[BinaryIO]:
    """Give a nameless file to write to and read from, which is gone afterwards. Raises OSError."""
    with tempfile.TemporaryFile() as stream:
        yield stream


@contextmanager
def open_partial(path: str) -> Iterator[TextIO]:
    """Give a text stream to `<path>.partial`, which takes the place of the path at the end.

    After an exception what was written stays in the partial file and the path keeps its old
    contents. `-` is a private duplicate of standard output; devices and pipes are written
    directly. Raises OSError, so also BrokenPipeError.
    """
    if path == "-":
        if sys.stdout is not None:
            sys.stdout.flush()
        with _closing(os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")) as stream:
            yield stream
        return
    if is_direct(path):
        with _closing(Path(path).open("w", encoding="utf-8", newline="\n")) as stream:
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
        yield stream
        _flush_to_disk(stream)
        # Renamed while still locked, so that no other run can take the partial file.
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


def _read(path: Path, source: str, largest: int = MAX_TEXT_BYTES, is_binary: bool = False) -> str:
    with path.open("rb") as stream:
        content = stream.read(largest + 1)
    start = Span(source, 1, 1)
    if len(content) > largest:
        raise InvalidFile([Problem(start, f"the file is larger than {largest} bytes")])
    if is_binary:
        return content.decode("utf-8", "surrogateescape")
    try:
        return content.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8").removeprefix("\ufeff")
        lines = LINE_BREAK.split(before)
        span = Span(source, len(lines), len(lines[-1]) + 1)
        message = f"byte 0x{content[error.start]:02x} at offset {error.start} is not UTF-8"
        hint = "save the file as UTF-8"
        if content.startswith((b"\xff\xfe", b"\xfe\xff")):
            hint += ", it looks like UTF-16"
        texts = {source: content.decode("utf-8", "replace").removeprefix("\ufeff")}
        raise InvalidFile([Problem(span, message, hint)], texts) from error


def is_direct(path: str) -> bool:
    """Whether a path is a device, a pipe or a stream, which nothing can be put beside."""
    # Replacing /dev/stdout by a new file would take it from the shell that opened it.
    if str(Path(path).absolute()).startswith(_STREAMS):
        return True
    try:
        mode = Path(path).stat().st_mode
    except FileNotFoundError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _resolved_target(path: str) -> tuple[Path, int | None]:
    # The file behind all symbolic links, and its mode if it exists.
    target = Path(os.path.realpath(path))
    if path.endswith(os.sep) or target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    try:
        mode = stat.S_IMODE(target.stat().st_mode)
    except FileNotFoundError:
        return target, None
    # A rename needs no permission on the file itself, but its owner took it away on purpose.
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
    return target, mode


def _open_locked(path: Path) -> int:
    # Locks the file rather than leaving a lock file, which would outlive a killed run.
    flags = os.O_WRONLY | os.O_CREAT | _NO_FOLLOW | getattr(os, "O_NONBLOCK", 0)
    while True:
        raw = os.open(path, flags, 0o666)
        try:
            _lock(raw)
            # Another run may have renamed the file between the two lines above.
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(raw), path.stat()):
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
        raise OSError(errno.EBUSY, "another run is writing this file") from error
    except OSError:
        return  # some network file systems have no locks


def _flush_to_disk(stream: TextIO | BinaryIO) -> None:
    stream.flush()
    os.fsync(stream.fileno())


def _move_into_place(finished: Path, target: Path, mode: int | None) -> None:
    if mode is not None:
        finished.chmod(mode)
    finished.replace(target)
    # Without this a power cut may undo the rename; not every file system knows how.
    with suppress(OSError):
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def _with_path(error: OSError, path: str) -> OSError:
    return OSError(error.errno, error.strerror, path)


@contextmanager
def _closing(stream: TextIO) -> Iterator[TextIO]:
    # Closing flushes, so after a failed write it fails again and would hide the first error.
    try:
        yield stream
        stream.flush()
    except BaseException:
        with suppress(OSError):
            stream.close()
        raise
    stream.close()
