"""Read files, and do what else the program needs from the file system."""

from __future__ import annotations

import errno
import os
import re
import select
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from somo_cli.problems import LINE_BREAK, MAX_TEXT_BYTES, InvalidFile, Problem, Span

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")
_STREAMS = ("/dev/stdin", "/dev/stdout", "/dev/stderr", "/dev/fd/", "/proc/")
_BLOCK = 1 << 20  # bytes
MAX_WAIT = 5.0  # s for the writer of a pipe


def read_text(path: str, largest: int = MAX_TEXT_BYTES) -> str:
    """Return the text of a UTF-8 file of at most `largest` bytes, without its byte order mark.

    Raises OSError, and InvalidFile for a file that is larger or in another encoding.
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
    """Return the source and the text of a file that another file names, relative to itself.

    The file must lie in the folder of the naming file or below, or in that of the file `root`,
    unless files outside are allowed; else ValueError is raised. OSError and InvalidFile are raised
    as by `read_text`. In a binary file, bytes that are not UTF-8 become surrogates.
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


def relative_path(path: str, other: str) -> str:
    """Return a path relative to the folder of `other`, with slashes; absolute on another drive."""
    folder = os.path.realpath(Path(other).parent)
    try:
        return Path(os.path.relpath(os.path.realpath(path), folder)).as_posix()
    except ValueError:
        return Path(path).absolute().as_posix()


def copy_examples(folder: str) -> list[str]:
    """Copy the shipped definitions and their schemas into a new folder; return the copies' paths.

    The folder is complete or does not exist. Raises OSError, also if the folder exists.
    """
    here = Path(__file__).parent
    shipped = here if (here / "definitions").is_dir() else here.parent  # wheel, else checkout
    target = Path(folder)
    if os.path.lexists(target):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), folder)
    target.parent.mkdir(parents=True, exist_ok=True)
    unfinished = Path(tempfile.mkdtemp(prefix=".somo-", dir=target.parent))
    try:
        unfinished.chmod(0o777 & ~_umask())
        for part in ("definitions", "schemas"):
            shutil.copytree(shipped / part, unfinished / part)
        unfinished.rename(target)
    except shutil.Error as error:  # a list of what could not be copied, and why
        source, _, reason = error.args[0][0]
        raise OSError(errno.EIO, f"{Path(source).name} was not copied: {reason}", folder) from error
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)
    return sorted(str(path) for path in (target / "definitions").glob("*.yaml"))


def _umask() -> int:
    """Return the permissions that new files lack; asking for them sets them."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def open_standard_streams() -> None:
    """Open the null device for each standard stream that the shell closed.

    Otherwise the next opened file would get the descriptor, and everything that is printed. On
    standard output it is open for reading only, so that writing fails, as it should.
    """
    access = (("stdin", "r", os.O_RDONLY), ("stdout", "w", os.O_RDONLY), ("stderr", "w", os.O_RDWR))
    for descriptor, (name, mode, flags) in enumerate(access):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, flags)  # the lowest descriptor that is free
        if getattr(sys, name) is None:
            stream = os.fdopen(descriptor, mode, encoding="utf-8", closefd=False)
            setattr(sys, name, stream)


def drop_standard_output() -> None:
    """Lead standard output to the null device: Python must not flush what is left into it."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


@contextmanager
def temporary_file() -> Iterator[BinaryIO]:
    """Yield a nameless file to write and read, which is deleted afterwards. Raises OSError."""
    with tempfile.TemporaryFile() as stream:
        yield stream


def _opened(path: Path, source: str) -> BinaryIO:
    """Return an open file; a pipe by name must have someone who writes within `MAX_WAIT`."""
    if not stat.S_ISFIFO(path.stat().st_mode) or str(path.absolute()).startswith(_STREAMS):
        return path.open("rb")
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    if not select.select([descriptor], [], [], MAX_WAIT)[0]:
        os.close(descriptor)
        message = f"nobody has written to this pipe for {MAX_WAIT:g} s"
        raise OSError(errno.ETIMEDOUT, message, source)
    os.set_blocking(descriptor, True)
    return os.fdopen(descriptor, "rb")


def _bytes_of(stream: BinaryIO, source: str, largest: int, is_binary: bool) -> bytes:
    """Return at most `largest` bytes, read in blocks: what is no text may have no end."""
    blocks = []
    size = 0
    while block := stream.read(_BLOCK):
        size += len(block)
        if size > largest:
            message = f"the file is larger than {largest} bytes"
            raise InvalidFile([Problem(Span(source, 1, 1), message)])
        if not is_binary and len(block) == _BLOCK and b"\0" in block:
            raise InvalidFile([Problem(Span(source, 1, 1), "this is no text: it has zero bytes")])
        blocks.append(block)
    return b"".join(blocks)


def _read(path: Path, source: str, largest: int = MAX_TEXT_BYTES, is_binary: bool = False) -> str:
    with _opened(path, source) as stream:
        content = _bytes_of(stream, source, largest, is_binary)
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
