"""A small part of `make contact`: forces, grips and impacts against references, and limits."""

from __future__ import annotations

import dataclasses
import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from somo_cli.calibration.moment_arms import of_definition
from somo_cli.problems import SimulationDiverged
from somo_cli.scene.columns import header
from somo_cli.simulation.engine.bullet import collision_filter
from somo_cli.simulation.plan.build import make_plan
from tests.builders.command import Somo
from tests.builders.runs import rows_of
from tests.builders.scenes import DEFINITIONS, scene_from_file
from tests.contact import second_opinion
from tests.contact.candidates import EXPLICIT, PLAIN, Candidate, filters
from tests.contact.cases import REACH, Case, blocked, box, case_scene, cases, finger, named
from tests.contact.chatter import shake
from tests.contact.trial import recorded, trial

pytest.importorskip("pybullet")

FINE = 1e-4  # s
# of the cases whose figure is converged there; the others are in `make contact`
NAMES = [case.name for case in cases() if not case.is_slow]


@cache
def converged(name: str) -> float:
    return trial(named(name), FINE, EXPLICIT).figure


@pytest.mark.moderate
@pytest.mark.parametrize("step", [2e-3, 1e-3, 5e-4])
def test_blocked_force_is_that_of_the_closed_form(step: float) -> None:
    scene = scene_from_file("finger.yaml")
    compiled = scene.manipulators[0].compiled
    base = compiled.chain.length - 0.1
    # the force acts on the middle of the ball, which is beyond the end of the actuator
    moment_arms = dataclasses.replace(of_definition(compiled.definition, 0, 0), at=REACH - base)
    found = trial(blocked(), step).figure
    assert found == pytest.approx(0.005 / moment_arms.torque(1.0), rel=1e-3)
    assert found == pytest.approx(trial(blocked(), FINE, EXPLICIT).figure, rel=1e-9)


@pytest.mark.moderate
@pytest.mark.parametrize("step", [2e-3, 1e-3])
def test_two_fingers_hold_a_cube(step: float) -> None:
    table, _ = recorded(named("cube of 10 g, 2 fingers"), step)
    grip = table["finger_0.contact.normal_n"][-1]
    assert grip == pytest.approx(converged("cube of 10 g, 2 fingers"), rel=1e-4)
    # what it stood on is gone, and it has not sunk
    assert table["support.pose.x_m"][-1] < -0.18
    assert abs(table["cube.pose.z_m"][-1]) < 2e-3


def test_a_wall_is_struck_as_in_another_engine() -> None:
    case = named("wall struck, medium")
    theirs = second_opinion.figure(case, 4e-5)
    assert trial(case, FINE, EXPLICIT).figure == pytest.approx(theirs, rel=5e-4)
    assert trial(case, 1e-3).figure == pytest.approx(theirs, rel=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_case_holds_up_to_2_ms(name: str) -> None:
    for step in (2e-3, 1e-3):
        assert trial(named(name), step).figure == pytest.approx(converged(name), rel=0.05), step


@pytest.mark.slow
def test_the_snake_gets_as_far_at_any_step() -> None:
    case = named("snake on the ground")
    for step in (2e-3, 1e-3, 5e-4):
        assert trial(case, step).figure == pytest.approx(converged(case.name), rel=0.1), step


@pytest.mark.moderate
@pytest.mark.parametrize(("step", "most"), [(4e-3, 1e-2), (2e-3, 4e-3), (1e-3, 1e-4), (5e-4, 1e-9)])
@pytest.mark.parametrize("name", ["finger sinks to the ground", "finger dropped"])
def test_contact_gives_no_energy(name: str, step: float, most: float) -> None:
    """But for what the engine does to push out what a large step let in."""
    assert trial(named(name), step).growth < most


def snake_that_falls_on_its_end() -> Case:
    snake = {"definition": "snake.yaml", "base": "free", "position": [0, 0, 0.25]}
    scene = case_scene([snake | {"rpy": [0.4, 0.9, 0]}], ground={})
    return Case("snake falls", "", scene, 0.3, lambda table: 0.0, columns=("energy",))


@pytest.mark.slow
def test_a_snake_that_falls_on_its_end_takes_up_no_energy() -> None:
    """Light links spin at once; bias forces extrapolated with the impact gave it 77 times E."""
    table, _ = recorded(snake_that_falls_on_its_end(), 1e-3)
    energy = sum(values for name, values in table.items() if name.endswith("_j"))
    assert energy.max() <= energy[0] * (1 + 1e-9)
    assert energy[-1] < 0.9 * energy[0]


def test_a_snake_that_is_thrown_up_by_its_fall_is_noticed() -> None:
    """Though it flies away as a whole, faster than its joints move."""
    with pytest.raises(SimulationDiverged, match="times what was put in"):
        recorded(snake_that_falls_on_its_end(), 4e-3)


@pytest.mark.slow
def test_a_finger_curls_as_far_at_any_step() -> None:
    found = [trial(named("curled onto its base"), step).figure for step in (2e-3, 1e-3, 2.5e-4)]
    assert found[:2] == pytest.approx([found[2]] * 2, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("candidate", list(filters()), ids=lambda one: one.name)
def test_no_filter_of_the_measured_force_is_worth_it(candidate: Candidate) -> None:
    """Why the law takes the force as it is: over three impacts none takes a tenth off the error."""
    impacts = [case for case in cases() if case.name.startswith("wall struck")]
    truths = [converged(case.name) for case in impacts]
    own, other = (
        math.fsum(
            abs(trial(case, 1e-3, law).figure / truth - 1)
            for case, truth in zip(impacts, truths, strict=True)
        )
        for law in (PLAIN, candidate)
    )
    assert 0.9 * own < other


def test_a_sliding_finger_with_strong_dampers_shakes_little() -> None:
    """By 1e-3 rad and more at 2 ms while the law answered contact a step late."""
    assert shake(PLAIN, 300, 2e-3) < 5e-4
    assert shake(PLAIN, 300, 5e-4) < 1e-4
    assert shake(PLAIN, 30, 2e-3) < 1e-4


def written(folder: Path, torque: float) -> Path:
    wall = box("wall", [0.1, 0.02, 0.1], [0, -0.03, 0.1], fixed=True)
    scene = case_scene([finger("finger", torque)], [wall], gravity=[0, 0, 0])
    (folder / "finger.yaml").write_text((DEFINITIONS / "finger.yaml").read_text("utf-8"), "utf-8")
    path = folder / "scene.json"
    path.write_text(json.dumps(scene), "utf-8")
    return path


@pytest.mark.moderate
def test_a_run_says_where_contact_was_not_followed(somo: Somo, tmp_path: Path) -> None:
    done = somo("run", written(tmp_path, 0.1), "--steps", "40", "--time-step", "6e-3", "--quiet")
    assert done.returncode == 0
    start = "somo: warning: at 0.024 s 'finger' and 'wall' were 4.4"
    assert done.stderr.startswith(start)
    assert "try half the step, --time-step 0.003" in done.stderr


def test_a_run_that_contact_throws_off_stops(somo: Somo, tmp_path: Path) -> None:
    done = somo("run", written(tmp_path, 0.1), "--steps", "40", "--time-step", "2e-2", "--quiet")
    assert done.returncode == 4
    assert "it turns" in done.stderr
    assert "try half the step, --time-step 0.01" in done.stderr


@pytest.mark.moderate
def test_a_run_that_follows_contact_says_nothing(somo: Somo, tmp_path: Path) -> None:
    done = somo("run", written(tmp_path, 0.1), "--steps", "100", "--time-step", "2e-3", "--quiet")
    assert (done.returncode, done.stderr) == (0, "")


def test_the_solver_stops_where_more_of_it_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = dataclasses.replace(scene_from_file("lift_scene.yaml"), every=100)
    rows = np.array(rows_of(scene, 700))
    monkeypatch.setattr(collision_filter, "squared_residual_speed", lambda plan: 1e-30)
    exact = np.array(rows_of(scene, 700))
    names = header(make_plan(scene).recorded)
    poses = [place for place, name in enumerate(names) if ".pose." in name or "angle" in name]
    assert np.abs(rows - exact)[:, poses].max() < 1e-9
