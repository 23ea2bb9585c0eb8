"""Every command once, in one process, so that the fast tests reach every module of the package.

A module is reached if a function of it runs here, or if a test that is neither slow nor moderate
imports it by name. What each command gives in detail is tested elsewhere.
"""

from __future__ import annotations

import ast
import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.imports import PACKAGE, SOURCES, imports, module_name, module_of

# Runs the commands of argv[1] (JSON) one after the other, then two steps by the Python API. Writes
# the exit codes, the time reached and the files whose functions ran to argv[2].
COMMANDS_IN_ONE_PROCESS = """
import json, runpy, sys, threading
from pathlib import Path
seen, files, codes = set(), set(), []
def note(frame, event, argument):
    code = frame.f_code
    if event == "call" and code not in seen:
        seen.add(code)
        if code.co_name != "<module>":
            files.add(code.co_filename)
commands, target = json.loads(sys.argv[1]), sys.argv[2]
sys.setprofile(note)
threading.setprofile(note)
for arguments in commands:
    sys.argv = ["somo", *arguments]
    try:
        runpy.run_module("somo_cli", run_name="__main__")
    except SystemExit as ended:
        codes.append(ended.code)
import somo_cli
document = somo_cli.load("shipped/definitions/scene.yaml")
with somo_cli.Simulation(document) as simulation:
    simulation.step(2)
    codes.append(simulation.time)
somo_cli.simulate(document, steps=20, tolerance=0.1)
sys.setprofile(None)
Path(target).write_text(json.dumps({"codes": codes, "files": sorted(files)}))
"""
RING_DOWN = "time_s,tip.y_m\n" + "".join(
    f"{t!r},{0.01 + 0.005 * math.exp(-0.5 * t) * math.cos(15.6 * t)!r}\n"
    for t in (0.01 * n for n in range(300))
)
FORCES = "pressure_pa,force_n\n2e4,0.14\n4e4,0.31\n6e4,0.44\n8e4,0.61\n1e5,0.75\n"
MOVED = """
objects:
  - {name: one, shape_type: sphere, dimensions: [0.1], motion: {file: poses.csv}}
  - {name: b, shape_type: sphere, dimensions: [0.1], position: [1, 0, 0], motion: {trajectory: way}}
trajectories:
  - name: way
    sorotraj:
      settings: {traj_type: direct}
      config: {setpoints: {main: [[0, 0, 0, 0], [1, 0, 0, 1]]}}
"""
POSES = "time_s,qx,qy,qz,qw\n0,0,0,0,1\n1,0,0,0.6,0.8\n"
FIVE = ("--steps", "5")
SELF_COLLISION = "manipulators[0].self_collision=true"
OBJECTS = Path(__file__).parent / "objects" / "inputs"
SHORT = ("--steps", "120", "--every", "10")
COMMANDS = (
    ("examples", "shipped"),
    ("help", "tour"),
    ("new", "gripper", "own"),
    ("new", "arm", "long"),
    ("new", "study", "varied", "--of", "own_scene.yaml"),
    ("show", "shipped/definitions/scene.yaml"),
    ("columns", "shipped/definitions/scene.yaml"),
    ("schema", "scene"),
    ("help", "spring_stiffness"),
    ("check", "shipped/definitions/press_scene.yaml", "--plan"),
    ("check", "wrong.yaml"),
    ("build", "shipped/definitions/finger.yaml", "-o", "finger.urdf"),
    ("build", "shipped/definitions/finger.yaml", "--for", "drake", "-o", "finger.sdf"),
    ("build", "shipped/definitions/cantilever.yaml", "--for", "mujoco", "-o", "beam.xml"),
    ("build", "shipped/definitions/lift_scene.yaml", "--for", "mujoco", "-o", "lift.xml"),
    ("import", "finger.sdf", "-o", "found.yaml"),
    ("import", "beam.xml", "-o", "-"),
    ("build", "shipped/definitions/hand.yaml", "-o", "hand.urdf"),
    ("import", "hand.urdf"),
    ("run", "shipped/definitions/scene.yaml", *SHORT, "--error", "-o", "rows.csv"),
    ("run", "shipped/definitions/scene.yaml", *SHORT, "--tolerance", "0.1", "-o", "known.csv"),
    ("check", "shipped/definitions/scene.yaml", "--numerics", "--trajectory", "rows.csv"),
    ("run", "shipped/definitions/lift_scene.yaml", *FIVE, "-o", "lift.csv"),
    ("run", "shipped/definitions/tumble_scene.yaml", *FIVE, "-o", "tumble.csv"),
    ("run", "shipped/definitions/scene.yaml", *FIVE, "--set", SELF_COLLISION, "-o", "self.csv"),
    ("run", str(OBJECTS / "little.yaml"), *FIVE, "-o", "urdf.csv"),
    ("run", "moved.yaml", *FIVE),
    ("render", "rows.csv", "--size", "64x48", "-o", "picture.png"),
    ("render", "shipped/definitions/scene.yaml", "--size", "64x48", "-o", "start.png"),
    (
        "report", "shipped/definitions/cantilever_scene.yaml", "--set", "reference=elastica",
        "--segments", "2,4", "--duration", "0.2", "--time-steps", "2e-2", "--integrators",
        "implicit", "--repeats", "1", "-o", "report",
    ),
    (
        "calibrate", "stiffness", "--patch", "shipped/definitions/finger.yaml",
        "--tip-stiffness", "6.12",
    ),
    ("calibrate", "torque", "shipped/definitions/finger.yaml", "--data", "forces.csv"),
    ("calibrate", "damping", "shipped/definitions/finger.yaml", "--ring-down", "ring.csv"),
    (
        "calibrate", "fit", "shipped/definitions/scene.yaml", "--data", "rows.csv",
        "--parameters", "stiffness", "--columns", "finger.tip.y_m", "--json",
    ),
    ("sweep", "study.yaml", "-j", "1", "-o", "swept", "--best", "reach"),
    ("plot", "swept/results.csv", "--lines", "torque", "--value", "reach", "-o", "lines.png"),
    ("plot", "rows.csv", "-o", "rows.png"),
)  # fmt: skip
STUDY = """
scene: shipped/definitions/scene.yaml
steps: 10
parameters:
  torque: {path: "manipulators[0].actuation[0].waypoints[1][1]", values: [0.01]}
labels:
  reach: {of: finger.tip.z_m, take: last}
"""
RESULTS = (
    "finger.urdf",
    "found.yaml",
    "hand.yaml",
    "rows.csv",
    "rows.meta.json",
    "picture.png",
    "report/report.csv",
    "swept/results.csv",
)


def fast_imports() -> set[str]:
    """Return the modules that test modules import by name which hold a fast test."""
    found: set[str] = set()
    for path in sorted(Path(__file__).parent.rglob("test_*.py")):
        source = path.read_text("utf-8")
        if has_fast_test(source):
            ours = (target for target, _, _ in imports(source) if target.startswith("somo_cli"))
            found.update(module_of(target) for target in ours)
    return found


def has_fast_test(source: str) -> bool:
    """Whether a test module holds a test that `make test-fast` runs."""
    tree = ast.parse(source)
    marks = [
        ast.unparse(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "pytestmark"
    ]
    if any(is_left_out(mark) for mark in marks):
        return False
    tests = [one for one in tree.body if isinstance(one, ast.FunctionDef)]
    return any(
        one.name.startswith("test_")
        and not any(is_left_out(ast.unparse(mark)) for mark in one.decorator_list)
        for one in tests
    )


def is_left_out(mark: str) -> bool:
    """Whether a mark keeps a test from the fast ones."""
    return any(name in mark for name in ("mark.slow", "mark.moderate", "mark.bench"))


def has_functions(source: str) -> bool:
    """Whether there is a function in a module that could run."""
    return any(isinstance(node, ast.FunctionDef) for node in ast.walk(ast.parse(source)))


def test_fast_tests_reach_every_module(tmp_path: Path, environment: dict[str, str]) -> None:
    for needed in ("pybullet", "matplotlib"):
        pytest.importorskip(needed)
    (tmp_path / "ring.csv").write_text(RING_DOWN)
    (tmp_path / "wrong.yaml").write_text("time_step: -1\nmanipulators: []\n")
    (tmp_path / "moved.yaml").write_text(MOVED)
    (tmp_path / "poses.csv").write_text(POSES)
    (tmp_path / "forces.csv").write_text(FORCES)
    (tmp_path / "study.yaml").write_text(STUDY)
    ended = subprocess.run(
        [sys.executable, "-c", COMMANDS_IN_ONE_PROCESS, json.dumps(COMMANDS), "reached.json"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    reached = json.loads((tmp_path / "reached.json").read_text("utf-8"))
    expected = [int("wrong.yaml" in command) for command in COMMANDS]
    assert reached["codes"] == [*expected, 0.002], ended.stderr
    assert [name for name in RESULTS if not (tmp_path / name).is_file()] == []
    paths = [Path(file) for file in reached["files"]]
    ran = {module_name(path) for path in paths if path.is_relative_to(PACKAGE)}
    able = {module for module, source in SOURCES.items() if has_functions(source)}
    assert sorted(able - ran - fast_imports()) == []
