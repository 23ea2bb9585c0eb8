"""What every test may ask for: the real command, and whether golden files are to be rewritten."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import somo_cli
from tests.builders.command import Somo

# Whatever makes typer, rich or Python itself speak differently in a pipe than on a fresh machine.
_LOUD = (
    "CI",
    "CLICOLOR",
    "CLICOLOR_FORCE",
    "COLUMNS",
    "FORCE_COLOR",
    "GITHUB_ACTIONS",
    "LINES",
    "NO_COLOR",
    "PYTHONWARNINGS",
    "PY_COLORS",
    "TERMINAL_WIDTH",
    "TTY_COMPATIBLE",
    "TTY_INTERACTIVE",
)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--rewrite-golden",
        action="store_true",
        help="write the golden files anew instead of comparing with them",
    )


def pytest_configure() -> None:
    """Undo what a shell, or `nohup`, has ignored: every process that a test starts inherits it."""
    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name) and signal.getsignal(signal.Signals[name]) is signal.SIG_IGN:
            signal.signal(signal.Signals[name], signal.SIG_DFL)
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def rewrite_golden(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--rewrite-golden"))


@pytest.fixture(scope="session")
def environment() -> dict[str, str]:
    """The environment for processes of ours, the same on every machine."""
    quiet = {key: value for key, value in os.environ.items() if key not in _LOUD}
    # The tree under test, wherever the command runs, installed or not.
    return quiet | {"PYTHONPATH": str(Path(somo_cli.__file__).parents[1]), "TERM": "dumb"}


@pytest.fixture
def narrow_umask() -> Iterator[None]:
    """New files can be read by their owner and the group, whatever the umask of the machine."""
    before = os.umask(0o027)
    yield
    os.umask(before)


@pytest.fixture
def somo(tmp_path: Path, environment: dict[str, str]) -> Somo:
    """Run the command in a process of its own, by default in `tmp_path`: `somo("check", path)`."""

    def run(
        *arguments: str | Path,
        cwd: Path = tmp_path,
        stdin: str = "",
        env: dict[str, str] | None = None,
        timeout: float = 120.0,  # s
    ) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "somo_cli", *map(str, arguments)],
            cwd=cwd,
            input=stdin,
            env=environment | (env or {}),
            timeout=timeout,
            capture_output=True,
            encoding="utf-8",
            check=False,
        )

    return run
