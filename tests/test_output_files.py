from __future__ import annotations

import contextlib
import errno
import io
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from somo_cli import output_files
from somo_cli.output_files import open_partial, write_atomically
from tests.builders.files import mode_of, names_in

ROOT = getattr(os, "geteuid", lambda: 1)() == 0
pytestmark = pytest.mark.usefixtures("narrow_umask")


def test_a_file_is_written_as_the_umask_says(tmp_path: Path) -> None:
    path = tmp_path / "f.urdf"
    write_atomically(str(path), "ü\n")
    assert path.read_bytes() == "ü\n".encode()
    assert mode_of(path) == 0o640
    assert names_in(tmp_path) == ["f.urdf"]


def test_an_existing_file_keeps_its_mode(tmp_path: Path) -> None:
    path = tmp_path / "f.urdf"
    path.write_text("a much longer old text")
    path.chmod(0o604)
    write_atomically(str(path), "new")
    assert (path.read_text(), mode_of(path)) == ("new", 0o604)


def test_a_symbolic_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    link, real = tmp_path / "link", tmp_path / "real" / "file"
    link.symlink_to(real)
    for text in ("created", "replaced"):
        write_atomically(str(link), text)
        assert link.is_symlink()
        assert real.read_text() == text
        assert names_in(tmp_path / "real") == ["file"]
    with open_partial(str(link)) as stream:
        stream.write("streamed")
    assert link.is_symlink()
    assert real.read_text() == "streamed"


@pytest.mark.parametrize("call", ["fsync", "replace", "chmod", "write", "interrupt"])
def test_a_failure_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    path = tmp_path / "f.urdf"
    path.write_text("old")
    error = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def fail(*_: object, **__: object) -> None:
        raise KeyboardInterrupt if call == "interrupt" else error

    if call == "fsync":
        monkeypatch.setattr(os, "fsync", fail)
    elif call in ("replace", "chmod"):
        monkeypatch.setattr(Path, call, fail)
    else:
        monkeypatch.setattr(output_files, "_flush_to_disk", fail)
    expected = KeyboardInterrupt if call == "interrupt" else OSError
    with pytest.raises(expected) as caught:
        write_atomically(str(path), "new")
    if isinstance(caught.value, OSError):
        assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, str(path))
    monkeypatch.undo()
    assert path.read_text() == "old"
    assert names_in(tmp_path) == ["f.urdf"]


def test_a_place_that_cannot_be_written_raises_with_its_name(tmp_path: Path) -> None:
    for write in (
        lambda path: write_atomically(path, "x"),
        lambda path: open_partial(path).__enter__(),
    ):
        with pytest.raises(FileNotFoundError) as missing:
            write(str(tmp_path / "none" / "f"))
        assert missing.value.filename == str(tmp_path / "none" / "f")
        with pytest.raises(IsADirectoryError):
            write(str(tmp_path))
        with pytest.raises(IsADirectoryError):
            write(f"{tmp_path}/new/")
    assert names_in(tmp_path) == []


@pytest.mark.skipif(ROOT, reason="root may write everywhere")
def test_a_read_only_file_is_not_replaced(tmp_path: Path) -> None:
    path = tmp_path / "f"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(PermissionError):
        write_atomically(str(path), "new")
    with pytest.raises(PermissionError), open_partial(str(path)):
        pass
    assert (path.read_text(), names_in(tmp_path)) == ("old", ["f"])


def test_no_permission_to_write_is_respected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "f"
    path.write_text("old")
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(PermissionError) as caught:
        write_atomically(str(path), "new")
    assert caught.value.filename == str(path)
    assert path.read_text() == "old"


def test_devices_and_pipes_are_written_directly(tmp_path: Path) -> None:
    write_atomically("/dev/null", "text")
    with open_partial("/dev/null") as stream:
        stream.write("text")
    assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[str] = []
    for _ in range(2):
        reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
        reader.start()
        if not read:
            write_atomically(str(pipe), "whole")
        else:
            with open_partial(str(pipe)) as stream:
                stream.write("rows")
        reader.join()
    assert read == ["whole", "rows"]
    assert names_in(tmp_path) == ["pipe"]


def test_a_full_device_raises() -> None:
    with pytest.raises(OSError, match="No space left"):
        write_atomically("/dev/full", "text")
    with pytest.raises(OSError, match="No space left"), open_partial("/dev/full") as stream:
        stream.write("text")


def test_dev_stdout_is_not_replaced(tmp_path: Path) -> None:
    code = (
        "from somo_cli.output_files import write_atomically; write_atomically('/dev/stdout', 'x')"
    )
    out = tmp_path / "out"
    with out.open("w") as stream:
        number = os.fstat(stream.fileno()).st_ino
        subprocess.run([sys.executable, "-c", code], stdout=stream, check=True)
    assert (out.read_text(), out.stat().st_ino) == ("x", number)


# Writing row by row


def test_the_file_appears_when_the_rows_are_complete(tmp_path: Path) -> None:
    path = tmp_path / "f.csv"
    path.write_text("old")
    path.chmod(0o600)
    with open_partial(str(path)) as stream:
        stream.write("a,ü\n")
        stream.flush()
        assert path.read_text() == "old"
        assert (tmp_path / "f.csv.partial").read_bytes() == "a,ü\n".encode()
        stream.write("1,2\n")
    assert path.read_bytes() == "a,ü\n1,2\n".encode()
    assert mode_of(path) == 0o600
    assert names_in(tmp_path) == ["f.csv"]


def test_a_new_file_has_the_mode_the_umask_says(tmp_path: Path) -> None:
    with open_partial(str(tmp_path / "f.csv")):
        pass
    assert mode_of(tmp_path / "f.csv") == 0o640


@pytest.mark.parametrize("error", [ValueError("x"), KeyboardInterrupt(), BrokenPipeError()])
def test_after_an_exception_the_rows_so_far_are_kept_aside(
    tmp_path: Path, error: BaseException
) -> None:
    path = tmp_path / "f.csv"
    path.write_text("old")
    streams = []

    def run_until_error() -> None:
        with open_partial(str(path)) as stream:
            streams.append(stream)
            stream.write("row\n")
            raise error

    with pytest.raises(type(error)) as caught:
        run_until_error()
    assert caught.value is error
    assert streams[0].closed
    assert path.read_text() == "old"
    assert (tmp_path / "f.csv.partial").read_text() == "row\n"
    # The next run starts anew.
    with open_partial(str(path)) as stream:
        stream.write("2\n")
    assert path.read_text() == "2\n"
    assert names_in(tmp_path) == ["f.csv"]


def test_without_a_row_nothing_is_kept(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="x"), open_partial(str(tmp_path / "f.csv")):
        raise ValueError("x")
    assert names_in(tmp_path) == []


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_failure_at_the_end_keeps_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    path = tmp_path / "f.csv"
    path.write_text("old")

    def fail(*_: object) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(os if call == "fsync" else Path, call, fail)
    with pytest.raises(OSError, match="Input/output"), open_partial(str(path)) as stream:
        stream.write("row\n")
    monkeypatch.undo()
    assert path.read_text() == "old"
    assert (tmp_path / "f.csv.partial").read_text() == "row\n"


def test_a_full_disk_is_an_error_even_for_the_last_rows(tmp_path: Path) -> None:
    code = (
        "import resource, signal, sys; from somo_cli.output_files import open_partial\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))\n"
        "try:\n"
        "  with open_partial(sys.argv[1]) as stream:\n"
        "    stream.write('row\\n' * 1500)\n"
        "except OSError as error:\n"
        "  sys.exit(error.strerror)\n"
    )
    path = tmp_path / "f.csv"
    command = [sys.executable, "-W", "error", "-c", code, str(path)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stderr) == (1, "File too large\n")
    assert names_in(tmp_path) == ["f.csv.partial"]


def test_two_runs_cannot_write_one_file(tmp_path: Path) -> None:
    path = str(tmp_path / "f.csv")
    with open_partial(path) as stream:
        stream.write("first\n")
        stream.flush()
        with pytest.raises(OSError, match="another run is writing this file") as caught:
            open_partial(path).__enter__()
        assert caught.value.filename == path
    assert (tmp_path / "f.csv").read_text() == "first\n"


def test_a_partial_file_that_is_a_link_is_not_followed(tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("precious")
    (tmp_path / "f.csv.partial").symlink_to(victim)
    with pytest.raises(OSError, match="symbolic"):
        open_partial(str(tmp_path / "f.csv")).__enter__()
    assert victim.read_text() == "precious"


def run(code: str, **streams: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-W", "error", "-c", code]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, **streams)  # type: ignore[call-overload, no-any-return]


def test_standard_output_is_safe_from_redirections_of_its_descriptor() -> None:
    code = (
        "import os; from somo_cli.output_files import open_partial\n"
        "print('before')\n"
        "with open_partial('-') as stream:\n"
        "  stream.write('a\\n')\n"
        "  os.dup2(os.open(os.devnull, os.O_WRONLY), 1)\n"
        "  os.write(1, b'noise\\n')\n"
        "  stream.write('ü\\n')\n"
    )
    out, err = run(code, stdout=subprocess.PIPE, encoding="utf-8").communicate()
    assert (out, err) == ("before\na\nü\n", "")


def test_standard_output_stays_open() -> None:
    code = (
        "from somo_cli.output_files import open_partial\n"
        "with open_partial('-') as stream: stream.write('a\\n')\n"
        "print('b')\n"
    )
    assert run(code, stdout=subprocess.PIPE).communicate() == ("a\nb\n", "")


def test_a_closed_pipe_is_reported_to_the_caller() -> None:
    code = (
        "import sys; from somo_cli.output_files import open_partial\n"
        "try:\n"
        "  with open_partial('-') as stream:\n"
        "    sys.stdin.readline()\n"
        "    for _ in range(int(sys.argv[1])): stream.write('row\\n' * 100)\n"
        "except BrokenPipeError:\n"
        "  print('broken', file=sys.stderr)\n"
    )
    for rows in ("1", "10000"):  # the last flush fails, or one in between
        command = [sys.executable, "-W", "error", "-c", code, rows]
        with subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as process:
            assert process.stdout is not None
            process.stdout.close()
            process.stdout = None
            _, err = process.communicate("go\n")
        assert (process.returncode, err) == (0, "broken\n")


def test_a_closed_standard_output_raises() -> None:
    code = (
        "import os; os.close(1)\n"
        "from somo_cli.output_files import open_partial\n"
        "try:\n"
        "  open_partial('-').__enter__()\n"
        "except OSError as error:\n"
        "  os.write(2, error.strerror.encode())\n"
        "os._exit(0)\n"
    )
    assert run(code, stdout=subprocess.DEVNULL).communicate()[1] == "Bad file descriptor"


def test_output_is_the_same_bytes_in_every_locale(tmp_path: Path) -> None:
    with contextlib.redirect_stdout(io.StringIO()), open_partial(str(tmp_path / "f")) as stream:
        stream.write("1.5\r\nü\n")
    assert (tmp_path / "f").read_bytes() == "1.5\r\nü\n".encode()


def test_what_cannot_be_written_is_refused_and_nothing_is_made(tmp_path: Path) -> None:
    for path, error in (
        (tmp_path / "none/a.png", FileNotFoundError),
        (tmp_path, IsADirectoryError),
    ):
        with pytest.raises(error):
            output_files.refuse_unwritable(str(path))
    output_files.refuse_unwritable(str(tmp_path / "a.png"))
    output_files.refuse_unwritable(os.devnull)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="files are not locked there")
def test_what_a_killed_run_left_is_removed_and_what_another_writes_stays(tmp_path: Path) -> None:
    import fcntl

    abandoned, written = (tmp_path / f".somo-{name}.tmp" for name in ("dead", "live"))
    for path in (abandoned, written, tmp_path / ".somo-notes", tmp_path / "a.tmp"):
        path.write_text("kept", "utf-8")
    (tmp_path / ".somo-link.tmp").symlink_to(tmp_path / "a.tmp")
    (tmp_path / ".somo-folder.tmp").mkdir()
    with written.open("a") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        write_atomically(str(tmp_path / "f"), "new")
    assert {path.name for path in tmp_path.iterdir()} == {
        "f", "a.tmp", ".somo-notes", ".somo-live.tmp", ".somo-link.tmp", ".somo-folder.tmp",
    }  # fmt: skip
