"""What a script is told of contact that was not followed: warnings, metadata, exit codes."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.builders.command import Somo

DEFINITIONS = Path(__file__).parents[1] / "definitions"
THROWN = """\
time_step: 2e-3
manipulators:
  - definition: finger.yaml
objects:
  - name: ball
    shape_type: sphere
    dimensions: [0.01]
    mass: 0.01
    position: [0, -0.3, 0.05]
    linear_velocity: [0, 20, 0]
record: {columns: [tip_position], objects: [pose]}
"""
RUN = ("run", "thrown_scene.yaml", "--steps", "20")


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with a ball that jumps over a finger in one step, at 2 ms."""
    pytest.importorskip("pybullet")
    shutil.copy(DEFINITIONS / "finger.yaml", tmp_path)
    (tmp_path / "thrown_scene.yaml").write_text(THROWN, "utf-8")
    return tmp_path


@pytest.mark.moderate
def test_a_finding_is_a_warning_and_in_the_metadata(somo: Somo, here: Path) -> None:
    done = somo(*RUN)
    assert (done.returncode, done.stdout) == (0, "")
    warning = next(line for line in done.stderr.splitlines() if "[contact-missed]" in line)
    assert warning.startswith("somo: warning: at 0 s 'finger' and 'ball' are near each other and ")
    assert "  hint: take a step of at most " in done.stderr
    (found,) = json.loads((here / "thrown_scene.meta.json").read_text("utf-8"))["findings"]
    assert (found["code"], found["names"]) == ("contact-missed", ["finger", "ball"])
    assert found["motion_in_a_step_m"] == pytest.approx(0.04, rel=0.01)
    assert found["message"] in warning


@pytest.mark.moderate
def test_strict_ends_with_1_after_all_rows_were_written(somo: Somo, here: Path) -> None:
    assert somo(*RUN, "-q").returncode == 0
    rows = (here / "thrown_scene.csv").read_bytes()
    assert somo(*RUN, "-q", "--strict").returncode == 1
    assert (here / "thrown_scene.csv").read_bytes() == rows
    slow = ("--set", "objects[0].linear_velocity=[0, 1, 0]")
    assert somo(*RUN, "-q", "--strict", *slow).returncode == 0


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("codes", "stops"), [("any", True), ("[contact-missed]", True), ("[contact-shakes]", False)]
)
def test_a_finding_ends_the_run_where_the_scene_says_so(
    somo: Somo, here: Path, codes: str, stops: bool
) -> None:
    done = somo(*RUN, "--set", f"stop=[{{findings: {codes}}}]")
    assert done.returncode == 0
    meta = json.loads((here / "thrown_scene.meta.json").read_text("utf-8"))
    assert (meta["steps"] < 20) == stops
    if stops:
        assert meta["stopped_by"]["reason"].startswith("contact-missed: at 0 s 'finger' and 'ball'")


@pytest.mark.moderate
def test_a_simulation_says_what_it_found(here: Path) -> None:
    import somo_cli as somo

    with somo.Simulation(here / "thrown_scene.yaml") as simulation:
        assert simulation.findings() == ()
        simulation.step(20)
        assert [one.code for one in simulation.findings()] == ["contact-missed"]
        simulation.reset()
        assert simulation.findings() == ()
