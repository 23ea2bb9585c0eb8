"""Shipped files in a folder of their own, one of them mutated, and what commands say of it."""

from __future__ import annotations

import contextlib
import io
import re
import shutil
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path

from somo_cli import cli

_ROOT = Path(__file__).parents[2]
_SOURCES = (_ROOT / "definitions", _ROOT / "tests/cases/valid")
_READ = {".yaml", ".json", ".obj", ".stl", ".urdf", ".csv"}
_LINE = re.compile(r"\S.*:\d+:\d+: (?:error|warning|info): \S|    |  hint: |somo: |and \d+ more")
# words of Python and its libraries that no message should have
_INTERNAL = re.compile(
    r"Traceback|NoneType|object (?:is not|has no)|list index|arg is an empty|math domain|"
    r"could not convert|not supported between|unexpected keyword|broadcast|singular matrix|"
    r"KeyError|b3[A-Z]|division by zero|out of range for|<class| at 0x[0-9a-f]{8}"
)
CODES = {"check": {0, 1}, "build": {0, 3}, "run": {0, 3, 4}}


class Documents:
    """A copy of the shipped files in `folder`, in which one at a time is replaced."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for source in _SOURCES:
            shutil.copytree(source, folder, dirs_exist_ok=True)
        paths = sorted(path for path in folder.rglob("*") if path.suffix in _READ)
        self.texts = {
            path.relative_to(folder).as_posix(): path.read_text("utf-8", "surrogateescape")
            for path in paths
        }
        """The text of each file by its path within the folder."""

    def readers_of(self, name: str) -> list[str]:
        """Return the documents that tell of a file: itself, or those that name it."""
        if name.endswith((".yaml", ".json")):
            return [name]
        base = name.rsplit("/", 1)[-1]
        return [other for other, text in self.texts.items() if base in text and other != name]

    @contextlib.contextmanager
    def replaced(self, name: str, text: str) -> Iterator[None]:
        """Have another text in place of a file for a while."""
        path = self.folder / name
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        try:
            yield
        finally:
            path.write_text(self.texts[name], "utf-8", "surrogateescape", newline="")

    def kind(self, name: str) -> str:
        """Return what a document is as it was shipped: study, scene, trajectory or definition."""
        kinds = {"study": "labels", "scene": "manipulators|objects", "trajectory": "settings"}
        for kind, keys in kinds.items():
            if re.search(rf"^(?:{keys}):", self.texts[name], re.MULTILINE):
                return kind
        return "definition"


def faults_of(command: str, name: str, *options: str) -> tuple[int, list[str]]:
    """Return the exit code of a command on a document, in this process, and what is wrong."""
    code, messages = _ended(command, name, *options)
    faults = []
    if code not in CODES[command]:
        faults.append(f"exit code {code}")
    if found := _INTERNAL.search(messages):
        faults.append(f"'{found[0]}' in a message")
    lines = messages.split("\n")[:-1]
    faults += [f"a line without a place: {line[:200]!r}" for line in lines if not _LINE.match(line)]
    if code not in (0, 4) and ": error: " not in messages:
        faults.append("no error is named")
    if faults:
        faults.append(messages[-1500:])
    return code, faults


def _ended(*arguments: str) -> tuple[int, str]:
    messages = io.StringIO()
    before = sys.argv
    sys.argv = ["somo", *arguments]
    try:
        with contextlib.redirect_stderr(messages), contextlib.redirect_stdout(io.StringIO()):
            cli.main()
    except SystemExit as ended:
        return int(ended.code or 0), messages.getvalue()
    except Exception:
        return -1, messages.getvalue() + traceback.format_exc()
    finally:
        sys.argv = before
    return 0, messages.getvalue()
