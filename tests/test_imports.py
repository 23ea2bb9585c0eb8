"""What each command imports: which libraries, and which rooms of ours; nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.imports import PACKAGE
from tests.architecture.law import HOMES, room_of
from tests.builders.scenes import DEFINITIONS

IMPORTED = """
import sys
from somo_cli.cli import main
try:
    main()
except SystemExit as ended:
    code = ended.code
ours = {name.partition(".")[2] for name in sys.modules if name.startswith("somo_cli.")}
print(*sorted({name.split(".")[0] for name in sys.modules}), file=sys.stderr)
print(*sorted(ours), file=sys.stderr)
sys.exit(code)
"""
TYPER = {"typer"}
CHECKING = TYPER | {"jsonschema", "referencing", "yaml", "xml"}
RUNNING = CHECKING | {"numpy", "pybullet"}

DOOR = {
    "budget",
    "cli",
    "files",
    "output_files",
    "problems",
    "signals",
    "terminal",
    "terminal_text",
}
LOADING = DOOR | {
    "document",
    "document_kinds",
    "loading",
    "manipulator",
    "packages",
    "scene",
    "scene.checks",
}
BUILDING = LOADING | {"exchange"}
PLANNED = LOADING | {
    "arrays",
    "simulation",
    "simulation.dynamics",
    "simulation.engine",
    "simulation.integrator",
    "simulation.monitoring",
    "simulation.plan",
}
RUN = PLANNED | {"simulation.dynamics", "simulation.engine.bullet", "simulation.recording"}
API = RUN | {"api"}
CHECKED = LOADING | {"analysis", "arrays", "simulation.dynamics", "simulation.plan"}

FINGER = "finger.yaml"
SCENE = "scene.yaml"  # with cubic waypoints
TUMBLE = "tumble_scene.yaml"  # with a mesh
REPORT = ("report", FINGER, "--duration", "0.04", "--time-steps", "0.004")
STIFFNESS = ("calibrate", "stiffness", FINGER)
EXPECTED = {
    ("--version",): (TYPER, DOOR),
    ("--help",): (TYPER, DOOR),
    ("run", "--help"): (TYPER, DOOR),
    ("build", FINGER): (CHECKING, BUILDING),
    ("build", FINGER, "--verify"): (CHECKING | {"numpy", "scipy", "trimesh", "yourdfpy"}, BUILDING),
    ("check", FINGER): (CHECKING, LOADING),
    ("check", SCENE): (CHECKING, LOADING),
    ("check", SCENE, "--plan"): (CHECKING | {"numpy"}, PLANNED),
    ("check", SCENE, "--numerics"): (CHECKING | {"numpy", "scipy"}, CHECKED),
    ("run", FINGER, "--steps", "1"): (RUNNING, API),
    ("run", SCENE, "--steps", "1"): (RUNNING, API),
    ("run", TUMBLE, "--steps", "1"): (RUNNING | {"scipy", "trimesh"}, API),
    ("run", SCENE, "--steps", "9", "--error"): (RUNNING, API | {"analysis"}),
    REPORT: (RUNNING | {"matplotlib"}, RUN | {"analysis", "picture"}),
    STIFFNESS: (CHECKING | {"numpy", "scipy"}, LOADING | {"analysis", "arrays", "calibration"}),
}


def imported_by(
    arguments: tuple[str, ...], folder: Path, environment: dict[str, str]
) -> tuple[set[str], set[str]]:
    """Return which of the libraries that have a home are imported by a command, and which rooms."""
    files = [str(DEFINITIONS / one) if one.endswith(".yaml") else one for one in arguments]
    ended = subprocess.run(
        [sys.executable, "-c", IMPORTED, *files],
        cwd=folder,
        env=environment,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    *_, libraries, rooms = (set(line.split()) for line in ended.stderr.splitlines())
    # a package is in sys.modules for its inner rooms; a room counts when a file of it is imported
    files_of_ours = {name for name in rooms if not (PACKAGE / name.replace(".", "/")).is_dir()}
    return libraries & HOMES.keys() - {"csv"}, {room_of(name) or "" for name in files_of_ours}


@pytest.mark.slow
@pytest.mark.parametrize("arguments", EXPECTED, ids=" ".join)
def test_a_command_imports_what_it_uses_and_no_more(
    tmp_path: Path, environment: dict[str, str], arguments: tuple[str, ...]
) -> None:
    libraries, rooms = EXPECTED[arguments]
    for optional in libraries & {"matplotlib", "pybullet"}:
        pytest.importorskip(optional)
    assert imported_by(arguments, tmp_path, environment) == (libraries, rooms)
