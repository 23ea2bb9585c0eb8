"""Scenes without manipulators: bodies that fall, rest and collide, through every command."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import somo_cli
from somo_cli import loading
from somo_cli.api.result import Result
from somo_cli.manual.topics import page
from somo_cli.problems import InvalidFile, SimulationDiverged
from somo_cli.scene.checks.recording import select_by_patterns
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan_report import explain
from tests.builders.command import Somo

pytest.importorskip("pybullet")

G = 9.81  # m/s²
CUBE = "{name: cube, shape_type: box, dimensions: [0.04, 0.04, 0.04], mass: 0.05"
BALL = "{name: ball, shape_type: sphere, dimensions: [0.02], mass: 0.1"
ON_GROUND = f"""
time_step: 1e-3
world_scale: 20
ground: {{}}
objects:
  - {CUBE}, position: [0, 0, 0.02]}}
  - {BALL}, position: [0.1, 0, 1.0]}}
"""


def result_of(text: str, steps: int, **options: float) -> Result:
    return somo_cli.simulate(loading.load_text(text, "a.yaml"), steps, **options)


def placed_messages(text: str) -> list[tuple[int, int, str, str]]:
    return [
        (one.span.line, one.span.column, one.severity, one.message)
        for one in loading.check(loading.load_text(text, "a.yaml"))
    ]


@pytest.mark.parametrize("manipulators", ["", "manipulators: []\n"])
def test_a_ball_falls_as_bodies_fall(manipulators: str) -> None:
    text = f"{manipulators}{ON_GROUND}record: {{objects: [pose, velocity]}}\n"
    result = result_of(text, 400)
    time = result.time
    assert result["ball.pose.z_m"] == pytest.approx(1 - G * time**2 / 2, abs=1e-12)
    assert result["ball.velocity.z_m_per_s"] == pytest.approx(-G * time, abs=1e-12)


def test_only_the_poses_of_objects_are_recorded_by_default() -> None:
    names = result_of(ON_GROUND, 1).names
    of_pose = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")
    of_objects = [f"{name}.pose.{part}" for name in ("cube", "ball") for part in of_pose]
    assert list(names) == ["time_s", *of_objects]


def test_the_time_step_is_a_millisecond_by_default() -> None:
    assert result_of(ON_GROUND.replace("time_step: 1e-3", ""), 3).time.tolist()[-1] == 0.003
    assert result_of(ON_GROUND, 3, time_step=0.002).time.tolist()[-1] == 0.006


def test_a_block_rests_on_the_ground_with_its_weight() -> None:
    result = result_of(f"{ON_GROUND}record: {{objects: [pose, velocity, contact_force]}}", 1500)
    late = result.time > 1.0
    assert result["cube.pose.z_m"][late] == pytest.approx(0.02, abs=2e-6)
    assert np.abs(result["cube.velocity.z_m_per_s"][late]).max() < 1e-6
    assert result["cube.contact.fz_n"][late] == pytest.approx(0.05 * G, rel=1e-4)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_two_balls_collide_by_momentum_and_restitution(restitution: float) -> None:
    result = result_of(
        f"""
gravity: [0, 0, 0]
world_scale: 20
objects:
  - {BALL}, restitution: {restitution}, linear_velocity: [1, 0, 0]}}
  - {{name: other, shape_type: sphere, dimensions: [0.02], mass: 0.2, position: [0.1, 0, 0],
     restitution: 1}}
record: {{objects: [velocity]}}
""",
        150,
    )
    after = [float(result[f"{name}.velocity.x_m_per_s"][-1]) for name in ("ball", "other")]
    expected = [(1 - 2 * restitution) / 3, (1 + restitution) / 3]
    # the engine lets balls that rebound meet a step early, 5e-4 of the speed at this scale
    assert after == pytest.approx(expected, abs=1e-3)
    assert 0.1 * after[0] + 0.2 * after[1] == pytest.approx(0.1, abs=1e-9)


def test_the_example_of_the_manual_comes_to_rest_as_a_tower() -> None:
    (example,) = (
        block
        for block in re.findall(r"```yaml\n(.*?)```", page("scenes"), re.DOTALL)
        if "name: upper" in block
    )
    result = result_of(example, 5000)
    assert result.metadata["stopped_by"]["stop"] == 0
    assert result.time[-1] < 2.0
    assert result["lower.pose.z_m"][-1] == pytest.approx(0.02, abs=1e-5)
    assert result["upper.pose.z_m"][-1] == pytest.approx(0.055, abs=1e-5)


def test_stop_conditions_end_a_run() -> None:
    leaves = result_of(f"{ON_GROUND}stop: [{{object: ball, leaves: {{z: [0.5, 2]}}}}]", 1000)
    fallen = np.sqrt(2 * 0.5 / G)
    assert fallen < leaves.time[-1] <= fallen + 8e-3  # it is looked for every 8 steps
    rest = result_of(f"{ON_GROUND}stop: [{{at_rest: {{for: 0.1}}}}]", 3000)
    assert 0.55 < rest.time[-1] < 2.0


def test_it_is_stepped_from_python_and_starts_anew() -> None:
    with somo_cli.Simulation(loading.load_text(ON_GROUND, "a.yaml")) as simulation:
        assert (simulation.manipulators, simulation.objects) == ((), ("cube", "ball"))
        for _ in range(2):
            simulation.step(100)
            position, _ = simulation.object_pose("ball")
            assert position[2] == pytest.approx(1 - G * 0.1**2 / 2, abs=1e-12)
            simulation.reset()
        with pytest.raises(KeyError, match="has no 'finger'; it has no such names"):
            simulation.angles("finger")


def test_one_body_alone_has_nothing_to_touch() -> None:
    text = f"objects:\n  - {BALL}}}\nrecord: {{objects: [pose, contact_pairs]}}"
    plan = make_plan(loading.scene_of(loading.load_text(text, "a.yaml"))[0])
    assert not plan.can_touch
    time = (result := result_of(text, 200)).time
    assert result["ball.pose.z_m"] == pytest.approx(-G * time**2 / 2, abs=1e-12)
    with somo_cli.Simulation(loading.load_text(text, "a.yaml")) as simulation:
        simulation.step(200)
        first = simulation.object_pose("ball")[0].tolist()
        simulation.reset()
        simulation.step(200)
        assert simulation.object_pose("ball")[0].tolist() == first


def test_an_object_that_is_moved_needs_no_other() -> None:
    moved = "motion: {translation: [[0, 0, 0, 0], [0.1, 0, 0, 0.2]], interpolation: linear}"
    result = result_of(f"objects:\n  - {BALL}, {moved}}}", 100)
    assert result["ball.pose.z_m"] == pytest.approx(2 * result.time, abs=1e-12)


def test_the_plan_speaks_of_objects_alone() -> None:
    plan = make_plan(loading.scene_of(loading.load_text(ON_GROUND, "a.yaml"))[0])
    lines = [str(one) for one in explain(plan)]
    assert lines[0] == "kept      collision shapes: 2 objects, the ground can touch"
    assert not [line for line in lines if "joint" in line and "prediction" not in line]
    assert not [line for line in lines if " 0 " in line]


def test_one_that_spins_too_fast_diverges() -> None:
    text = f"objects:\n  - {CUBE}, angular_velocity: [0, 0, 5e3]}}"
    with pytest.raises(SimulationDiverged, match="turns 5 rad in one step") as caught:
        result_of(text, 100)
    assert caught.value.name == "cube"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            f"ground: {{}}\nobjects:\n  - {CUBE}, fixed: true}}",
            (1, 1, "error", "the scene has no manipulators and no object that can move, so nothing "
             "happens in it"),
        ),
        (
            f"manipulators: []\nobjects:\n  - {CUBE}, fixed: true}}",
            (1, 1, "error", "the scene has no manipulators and no object that can move, so nothing "
             "happens in it"),
        ),
        (
            f"objects:\n  - {CUBE}}}\ntime_step: auto",
            (3, 12, "error", "no time step can be chosen: one is chosen for joints of "
             "manipulators, and the scene has none"),
        ),
        (
            f"objects:\n  - {CUBE}}}\nrecord: {{columns: [energy]}}",
            (3, 10, "warning", "these are columns of manipulators, and the scene has none"),
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_is_said_at_its_place(
    text: str, expected: tuple[int, int, str, str]
) -> None:
    assert placed_messages(text) == [expected]


def test_an_automatic_step_is_refused_wherever_it_is_asked_for() -> None:
    with pytest.raises(InvalidFile, match="no time step can be chosen"):
        result_of(ON_GROUND, 1, time_step="auto")  # type: ignore[arg-type]


def test_a_pattern_that_matches_nothing_names_a_column() -> None:
    scene, _ = loading.scene_of(loading.load_text(ON_GROUND, "a.yaml"))
    with pytest.raises(ValueError, match=r"names of columns look like 'cube\.pose\.x_m'"):
        select_by_patterns(scene, ["finger.*"])


@pytest.mark.moderate
def test_every_command_takes_it_or_says_why_not(somo: Somo, tmp_path: Path) -> None:
    (tmp_path / "fall.yaml").write_text(ON_GROUND, "utf-8")
    assert somo("check", "fall.yaml", "--strict").stderr == ""
    numerics = somo("check", "fall.yaml", "--numerics")
    assert (numerics.returncode, numerics.stderr) == (0, "")
    assert numerics.stdout == (
        "implicit at 0.001 s: not judged, since there are no manipulators, whose springs limit a "
        "time step; run --error measures the error of the objects\n"
    )
    as_json = json.loads(somo("check", "fall.yaml", "--numerics", "--json").stdout)
    assert (as_json["manipulators"], as_json["explicit_step_s"]) == ({}, None)
    ran = somo("run", "fall.yaml", "--steps", "100", "--error", "--explain", "--events", "e.csv")
    assert ran.returncode == 0
    assert "estimated error" in ran.stderr
    meta = json.loads((tmp_path / "fall.meta.json").read_text("utf-8"))
    assert meta["manipulators"] == {}
    assert meta["error"]["columns"]["ball.pose.z_m"]["max"] < 1e-12
    assert (tmp_path / "e.csv").read_text("utf-8").count("cube") == 1
    refused = somo("report", "fall.yaml")
    assert (refused.returncode, refused.stdout) == (3, "")
    assert "there is no manipulator, and the report measures errors of tips" in refused.stderr


@pytest.mark.moderate
def test_it_is_drawn_as_it_falls(somo: Somo, tmp_path: Path) -> None:
    pytest.importorskip("imageio_ffmpeg")
    (tmp_path / "fall.yaml").write_text(ON_GROUND, "utf-8")
    start = somo("render", "fall.yaml", "--size", "64x48", "-o", "start.png")
    later = somo("render", "fall.yaml", "--size", "64x48", "--at", "0.3", "-o", "later.png")
    somo("run", "fall.yaml", "--steps", "300", "-q")
    recorded = somo("render", "fall.csv", "--size", "64x48", "-o", "recorded.png")
    film = somo("render", "fall.csv", "--size", "64x48", "-o", "film.gif")
    for one in (start, later, recorded, film):
        assert one.returncode == 0, one.stderr
    pictures = [(tmp_path / f"{name}.png").read_bytes() for name in ("start", "later", "recorded")]
    assert pictures[0] != pictures[1] == pictures[2]
    assert "8 pictures from 0 s to 0.28 s" in film.stderr


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (("fit", "fall.yaml", "--data", "rows.csv"), "a fit is about one"),
        (("damping", "fall.yaml", "--ratio", "0.1"), "a damping ratio is about one"),
    ],
)
def test_a_calibration_wants_a_manipulator(
    somo: Somo, tmp_path: Path, arguments: tuple[str, ...], what: str
) -> None:
    (tmp_path / "fall.yaml").write_text(ON_GROUND, "utf-8")
    (tmp_path / "rows.csv").write_text("time_s,tip.x_m\n0,0\n1,0\n", "utf-8")
    refused = somo("calibrate", *arguments)
    assert (refused.returncode, refused.stdout) == (3, "")
    assert f"fall.yaml:1:1: error: there is no manipulator, and {what}" in refused.stderr
