"""Scenes in which nothing moves are told before a run, and a run of them indeed does not move."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from somo_cli.loading import load, scene_of
from somo_cli.simulation.stillness import why_nothing_moves
from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS, scene_from_text

BEAM = "manipulators: [{definition: cantilever.yaml}]"
BALL = "{name: ball, shape_type: sphere, dimensions: [0.01], position: [1, 0, 1], mass: 1}"
COUNT = len(scene_from_text(BEAM).manipulators[0].compiled.chain.joints)
RATES = [1e-6] + [0] * (COUNT - 1)
DRIVE = "manipulators[0].actuation=[{actuator: 0, axis: 0, waypoints: [[0, 0], [1, %s]]}]"
LOAD = "manipulators[0].loads=[{link: tip, force: [%s, 0, 0]}]"


def told(*sets: str, text: str = BEAM) -> str:
    return why_nothing_moves(scene_from_text(text, *sets)) or ""


def test_an_upright_beam_stands_still() -> None:
    assert told().endswith("gravity bends no joint")
    assert told("gravity=[0, 0, 0]").endswith("there is no gravity")
    assert told("gravity=[0, 0, 0]", "manipulators[0].rpy=[0, 1.5708, 0]")


@pytest.mark.parametrize(
    "change",
    [
        "manipulators[0].rpy=[0, 1.5708, 0]",
        "gravity=[0.1, 0, -9.8]",
        DRIVE % 1e-9,
        LOAD % 1e-9,
        "manipulators[0].base=free",
        f"manipulators[0].initial_rates={RATES}",
        f"manipulators[0].initial_angles={RATES}",
        f"objects=[{BALL}]",
    ],
)
def test_whatever_moves_is_not_told(change: str) -> None:
    assert told(change) == ""


@pytest.mark.parametrize("change", [DRIVE % 0, LOAD % 0])
def test_a_drive_of_zero_is_none(change: str) -> None:
    assert told(change)


def test_every_shipped_scene_moves() -> None:
    for path in sorted(DEFINITIONS.glob("*.yaml")):
        if "manipulators" in yaml.safe_load(path.read_text("utf-8")):
            scene, _ = scene_of(load(str(path)))
            assert why_nothing_moves(scene) is None, path.name


@pytest.mark.moderate
def test_a_run_says_it_once_and_is_still(somo: Somo, tmp_path: Path) -> None:
    pytest.importorskip("pybullet")
    options = ("--steps", "200", "--every", "100", "-q", "-o", "-")
    ended = somo("run", DEFINITIONS / "cantilever.yaml", *options)
    assert ended.returncode == 0
    first, hint = ended.stderr.splitlines()
    assert first.startswith("somo: warning: nothing moves: ")
    assert hint.startswith("  hint: add actuation")
    rows = [line.partition(",")[2] for line in ended.stdout.splitlines()[1:]]
    values = [list(map(float, row.split(","))) for row in rows]
    assert values[-1] == pytest.approx(values[0], abs=1e-12)
