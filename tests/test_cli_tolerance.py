"""`run --tolerance` as a shell and as Python see it."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest

import somo_cli as somo_api
from tests.builders.command import SIMULATION, Somo, end_by, start_and_wait_for
from tests.builders.scenes import DEFINITIONS

SCENE = DEFINITIONS / "scene.yaml"
RUN = ("run", SCENE, "--steps", "200", "--every", "50")
FAST = "manipulators[0].initial_rates=5"


@pytest.mark.moderate
def test_a_run_halves_its_step_until_it_is_known(somo: Somo, tmp_path: Path) -> None:
    ended = somo(*RUN, "--set", FAST, "--tolerance", "1e-3")
    assert ended.returncode == 0, ended.stderr
    about = json.loads((tmp_path / "scene.meta.json").read_text("utf-8"))
    levels = about["refinement"]["levels"]
    step = about["time_step_s"]
    halvings = about["refinement"]["halvings"]
    assert step == 1e-3 / 2**halvings == levels[-1]["time_step_s"]
    assert len(levels) == halvings + 2
    assert about["error"]["is_converged"] is True
    assert about["error"]["worst"][0]["relative"] <= 1e-3
    lines = ended.stderr.splitlines()
    assert lines[0].startswith("scene.csv: 5 rows of 14 columns; ")
    assert lines[-1] == about["error"]["verdict"]
    assert lines[-1].startswith("converged to 0.0")
    factor = 2**halvings
    plain = ("--time-step", f"{step}", "--every", f"{50 * factor}", "-o", "-", "-q")
    same = somo("run", SCENE, "--steps", f"{200 * factor}", "--set", FAST, *plain)
    assert same.stdout == (tmp_path / "scene.csv").read_text("utf-8")


@pytest.mark.moderate
def test_what_does_not_converge_is_written_and_ends_with_1(somo: Somo, tmp_path: Path) -> None:
    options = ("--tolerance", "finger.tip.y_m=1e-15", "--halvings", "1", "-q")
    ended = somo(*RUN, *options)
    assert ended.returncode == 1
    last = ended.stderr.splitlines()[-1]
    assert last.startswith("NOT converged after 1 halving of the step, at 0.0005 s: finger.tip.y_m")
    about = json.loads((tmp_path / "scene.meta.json").read_text("utf-8"))
    assert about["error"]["is_converged"] is False
    assert len((tmp_path / "scene.csv").read_text("utf-8").splitlines()) == 6


@pytest.mark.moderate
def test_wrong_tolerances_are_usage_errors(somo: Somo, tmp_path: Path) -> None:
    for options, message in (
        (("--tolerance", "1e-2", "--error"), "leave --error out"),
        (("--tolerance", "tip"), "'tip' is neither a number nor COLUMN=NUMBER"),
        (("--tolerance", "finger.tip.w_m=1"), "no column matches 'finger.tip.w_m'; did you mean"),
    ):
        ended = somo(*RUN, *options)
        assert ended.returncode == 2
        assert message in " ".join(ended.stderr.split())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.moderate
def test_divergence_of_the_finest_run_ends_with_4(somo: Somo, tmp_path: Path) -> None:
    options = ("--set", "integrator=explicit", "--tolerance", "1e-2", "--halvings", "1")
    ended = somo(*RUN, *options)
    assert ended.returncode == 4
    assert "diverged" in ended.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.moderate
def test_events_are_those_of_the_finest_run(somo: Somo, tmp_path: Path) -> None:
    push = ("run", DEFINITIONS / "push_scene.yaml", "--record", "cube.pose.x_m", "-q")
    options = ("--tolerance", "1e-1", "--halvings", "1", "--events", "events.csv")
    ended = somo(*push, "--steps", "300", *options)
    assert ended.returncode in (0, 1), ended.stderr
    found = (tmp_path / "events.csv").read_text("utf-8")
    finer = ("--time-step", "0.0005", "--every", "20", "--events", "same.csv")
    assert somo(*push, "--steps", "600", *finer).returncode == 0
    assert found == (tmp_path / "same.csv").read_text("utf-8")
    assert len(found.splitlines()) > 1


@pytest.mark.moderate
@pytest.mark.parametrize("delay", [0.0, 0.5])
def test_an_interrupted_run_leaves_nothing(
    tmp_path: Path, environment: dict[str, str], delay: float
) -> None:
    command = [*map(str, RUN[:2]), "--steps", "9000000", "--tolerance", "1e-2"]
    with start_and_wait_for(SIMULATION, command, tmp_path, environment) as process:
        ended = end_by(process, signal.SIGINT, delay)
    assert ended == (130, "", "somo: interrupted\n")
    assert list(tmp_path.iterdir()) == []


def test_python_returns_the_finest_run_with_its_error() -> None:
    document = somo_api.load(str(SCENE), sets=[FAST])
    result = somo_api.simulate(document, 200, every=50, tolerance=1e-3)
    assert result.metadata["error"]["is_converged"] is True
    assert len(result) == 5
    assert result.metadata["time_step_s"] == 1e-3 / 2 ** result.metadata["refinement"]["halvings"]
    with pytest.warns(RuntimeWarning, match="NOT converged after 6 halvings of the step"):
        somo_api.simulate(document, 4, every=2, tolerance={"finger.tip.*": 1e-18})
    with pytest.raises(ValueError, match="no column matches"):
        somo_api.simulate(document, 4, tolerance={"nothing": 1.0})
