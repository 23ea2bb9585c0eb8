"""The program as a whole: closed and full streams, signals, pipes by name, nothing left behind."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from somo_cli import files
from tests.builders.command import Somo, end_by, start_and_wait_for

DEFINITIONS = Path(__file__).parents[1] / "definitions"
SOMO = (sys.executable, "-m", "somo_cli")
FULL = Path("/dev/full")


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with the shipped finger and its scene."""
    for name in ("finger.yaml", "scene.yaml"):
        shutil.copy(DEFINITIONS / name, tmp_path)
    return tmp_path


@pytest.mark.skipif(not FULL.exists(), reason="there is no /dev/full")
@pytest.mark.parametrize(
    "arguments",
    [("--help",), ("--version",), ("build", "finger.yaml", "-o", "-"), ("check", "--help")],
)
def test_a_full_disk_is_an_exit_code_and_a_message(
    here: Path, environment: dict[str, str], arguments: tuple[str, ...]
) -> None:
    with FULL.open("w") as full:
        done = subprocess.run(
            [*SOMO, *arguments],
            cwd=here,
            env=environment,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 5
    assert done.stderr == "somo: standard output: No space left on device\n"


@pytest.mark.moderate
@pytest.mark.skipif(os.name != "posix", reason="a shell closes the stream")
@pytest.mark.parametrize("arguments", ["--version", "build finger.yaml -o -"])
def test_a_closed_standard_output_is_no_success(
    here: Path, environment: dict[str, str], arguments: str
) -> None:
    command = f"'{sys.executable}' -m somo_cli {arguments} >&-"
    done = subprocess.run(
        command, cwd=here, env=environment, shell=True, stderr=subprocess.PIPE, text=True
    )
    assert done.returncode == 5
    assert done.stderr == "somo: standard output: Bad file descriptor\n"
    quiet = command.replace("-o -", "-q").replace("--version", "check finger.yaml")
    assert subprocess.run(quiet, cwd=here, env=environment, shell=True).returncode == 0


@pytest.mark.moderate
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_signal_leaves_whole_rows_and_nothing_temporary(
    here: Path, environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory, name: str
) -> None:
    pytest.importorskip("pybullet")
    temporary = tmp_path_factory.mktemp("temporary")
    with subprocess.Popen(
        [*SOMO, "run", "scene.yaml", "--steps", "100000000", "--every", "1", "-o", "x.csv"],
        cwd=here,
        env=environment | {"TMPDIR": str(temporary)},
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        partial = here / "x.csv.partial"
        give_up = time.monotonic() + 60
        while not (partial.exists() and partial.stat().st_size) and time.monotonic() < give_up:
            time.sleep(0.02)
        number = signal.Signals[name]
        process.send_signal(number)
        _, messages = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    first, second = messages.splitlines()[-2:]
    assert first == "somo: the rows so far are in x.csv.partial"
    ended = "interrupted" if name == "SIGINT" else f"terminated by signal {number:d}"
    assert second == f"somo: {ended}"
    assert partial.read_text("utf-8").endswith("\n")
    assert list(temporary.iterdir()) == []
    assert sorted(path.name for path in here.iterdir()) == [
        "finger.yaml", "scene.yaml", "x.csv.partial",
    ]  # fmt: skip


@pytest.mark.moderate
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize(
    "module", ["somo_cli.problems", "typer", "somo_cli.cli.check", "somo_cli.document"]
)
def test_an_interrupt_while_modules_load_is_no_traceback(
    here: Path, environment: dict[str, str], module: str
) -> None:
    with start_and_wait_for(module, ["check", "scene.yaml"], here, environment) as process:
        code, _, messages = end_by(process, signal.SIGINT)
    assert code == 130
    assert messages in ("", "somo: interrupted\n")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes by name")
def test_a_pipe_that_nobody_writes_to_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "pipe.yaml"
    os.mkfifo(path)
    monkeypatch.setattr(files, "MAX_WAIT", 0.05)
    with pytest.raises(OSError, match="nobody has written to this pipe") as caught:
        files.read_text(str(path))
    assert (caught.value.errno, caught.value.filename) == (errno.ETIMEDOUT, str(path))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes by name")
def test_a_pipe_that_is_written_in_parts_is_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "pipe.yaml"
    os.mkfifo(path)

    def write() -> None:
        with path.open("w") as stream:
            for part in ("a: 1\n", "b: 2\n"):
                stream.write(part)
                stream.flush()
                time.sleep(0.05)

    writer = threading.Thread(target=write)
    writer.start()
    assert files.read_text(str(path)) == "a: 1\nb: 2\n"
    writer.join()


def test_examples_are_copied_whole_or_not_at_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "a" / "examples"
    paths = files.copy_examples(str(folder))
    assert str(folder / "definitions" / "finger.yaml") in paths
    with pytest.raises(FileExistsError):
        files.copy_examples(str(folder))

    def refuse(source: str, target: str, **_: object) -> None:
        raise shutil.Error([(source, target, "[Errno 28] No space left on device")])

    monkeypatch.setattr(shutil, "copytree", refuse)
    with pytest.raises(OSError, match=r"definitions was not copied: .*No space") as caught:
        files.copy_examples(str(tmp_path / "more"))
    assert caught.value.filename == str(tmp_path / "more")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_examples_say_so_where_the_folder_exists(somo: Somo, here: Path) -> None:
    done = somo("examples", ".")
    assert (done.returncode, done.stdout, done.stderr) == (5, "", "somo: .: File exists\n")
