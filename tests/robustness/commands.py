"""Commands that write, in a folder of their own, and what each leaves when it is done."""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

import somo_cli

DEFINITIONS = Path(__file__).parents[2] / "definitions"
_INPUTS = ("finger.yaml", "scene.yaml", "push_scene.yaml")


@dataclass(frozen=True)
class Command:
    """Arguments of `somo`, its exit code, and its outputs; `same` always have the same bytes."""

    arguments: tuple[str, ...]
    same: frozenset[str]
    others: frozenset[str] = frozenset()
    code: int = 0
    uses_engine: bool = True

    @property
    def outputs(self) -> frozenset[str]:
        return self.same | self.others


COMMANDS = {
    "check": Command(("check", "scene.yaml"), frozenset(), uses_engine=False),
    "build": Command(
        ("build", "finger.yaml", "-o", "a.urdf"), frozenset({"a.urdf"}), uses_engine=False
    ),
    "run": Command(
        ("run", "push_scene.yaml", "--steps", "800", "--events", "e.csv", "-o", "a.csv"),
        frozenset({"a.csv", "e.csv"}),
        frozenset({"a.meta.json"}),
    ),
    "run --guarded": Command(
        ("run", "push_scene.yaml", "--steps", "800", "--guarded", "-o", "a.csv"),
        frozenset({"a.csv"}),
        frozenset({"a.meta.json"}),
    ),
    "run --error": Command(
        ("run", "scene.yaml", "--steps", "400", "--error", "-o", "a.csv"),
        frozenset({"a.csv"}),
        frozenset({"a.meta.json"}),
    ),
    "report": Command(
        ("report", "scene.yaml", "--duration", "0.05", "--repeats", "1", "-o", "r"),
        frozenset(),
        frozenset(f"r/report.{suffix}" for suffix in ("csv", "json", "png", "svg")),
    ),
    "render": Command(
        ("render", "scene.yaml", "--size", "160x120", "-o", "a.png"), frozenset({"a.png"})
    ),
    "calibrate": Command(
        ("calibrate", "stiffness", "--patch", "finger.yaml", "--tip-stiffness", "6.12"),
        frozenset({"finger.yaml"}),
        uses_engine=False,
    ),
    "examples": Command(("examples", "x"), frozenset({"x/definitions/finger.yaml"})),
}
"""By name; every command that writes a file is among them."""


def prepare(folder: Path) -> None:
    """Make a folder with the inputs, and one for temporary files beside it."""
    folder.mkdir()
    temporary_folder(folder).mkdir()
    for name in _INPUTS:
        shutil.copy(DEFINITIONS / name, folder)


def temporary_folder(folder: Path) -> Path:
    """Return the folder of the temporary files of commands that run in another."""
    return folder.with_name(folder.name + "-temporary")


def environment(folder: Path) -> dict[str, str]:
    """Return the environment for a command that runs in a folder."""
    own = {"PYTHONPATH": str(Path(somo_cli.__file__).parents[1]), "TERM": "dumb"}
    return os.environ | own | {"TMPDIR": str(temporary_folder(folder))}


def command_line(command: Command) -> list[str]:
    """Return the whole command, for this Python."""
    return [sys.executable, "-m", "somo_cli", *command.arguments]


def contents(folder: Path) -> dict[str, bytes]:
    """Return every file of a folder, hidden ones too, by its path within it."""
    paths = [path for path in folder.rglob("*") if path.is_file()]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def faults_of(
    command: Command, before: dict[str, bytes], whole: dict[str, bytes], folder: Path
) -> list[str]:
    """Return what is wrong with what a command left that ended early, or at its end.

    `before` are the inputs, `whole` what the command leaves when nothing disturbs it. Right are
    outputs that are whole or as they were before, and rows so far in `.partial`.
    """
    faults = []
    for name, found in contents(folder).items():
        is_old = before.get(name) == found
        if name.endswith(".partial"):
            is_right = name.removesuffix(".partial") in command.outputs and found.endswith(b"\n")
        elif name in command.same:
            is_right = is_old or whole[name] == found
        else:
            is_right = is_old or (name in whole and bool(found))
        if not is_right:
            faults.append(f"{name} of {len(found)} bytes")
    faults += [f"{name} is missing" for name in before if not (folder / name).exists()]
    return faults + [f"temporary {path.name}" for path in temporary_folder(folder).iterdir()]
