"""Overlaps at the start are reported with both names and the depth, before anything moves."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from somo_cli import loading
from somo_cli.problems import InvalidFile
from tests.builders.command import Somo
from tests.builders.definitions import BOX, Data, X, actuator, manipulator

pytest.importorskip("pybullet")

BODY = manipulator(
    actuator(4, X), world_scale=20, base_definition={**BOX, "dimensions": [0.02, 0.02, 0.02]}
)
CUBE: Data = {"name": "cube", "shape_type": "box", "dimensions": [0.04] * 3, "mass": 0.01}
PALM: Data = {"name": "palm", "shape_type": "box", "dimensions": [0.2, 0.2, 0.02], "fixed": True}


def overlap_messages(*objects: Data, others: tuple[Data, ...] = (), **of_scene: Any) -> list[str]:
    """Return every error of a scene, its place by the line's own text."""
    one = {"definition": BODY, "position": [9, 9, 9]}
    data = {"manipulators": [one, *others], "objects": list(objects), **of_scene}
    document = loading.load_text(json.dumps(data), "scene.json")
    assert loading.check(document) == ()
    found = loading.overlaps(document)
    if found:
        with pytest.raises(InvalidFile) as caught:
            loading.refuse_overlaps(document, loading.scene_of(document)[0])
        assert caught.value.problems == found
    return [problem.message for problem in found]


def test_two_objects() -> None:
    assert overlap_messages(PALM, {**CUBE, "position": [0.05, 0, 0.0279]}) == [
        "'cube' overlaps 'palm' by 2.1 mm at the start"
    ]


@pytest.mark.parametrize("height", [0.03, 0.02999, 0.031, 1.0])
def test_what_touches_does_not_overlap(height: float) -> None:
    assert overlap_messages(PALM, {**CUBE, "position": [0.05, 0, height]}) == []


def test_what_has_a_place_does_not_overlap() -> None:
    assert overlap_messages({**CUBE, "place": {"on": "palm"}}, PALM) == []


def test_what_is_placed_beside_what_it_does_not_know() -> None:
    other = {**CUBE, "name": "other", "position": [0.039, 0, 0.03]}
    assert overlap_messages({**CUBE, "place": {"on": "palm"}}, PALM, other) == [
        "'other' overlaps 'cube' by 1 mm at the start"
    ]


def test_what_cannot_move_may_stand_in_what_cannot() -> None:
    moved = {**PALM, "name": "moved", "motion": {"translation": [[0, 0, 0, 0]]}}
    del moved["fixed"]
    bases = tuple(
        {"definition": BODY, "name": base, "base": base, "position": [0, 0.01 * n, 0]}
        for n, base in enumerate(("static", "constrained"))
    )
    low = {**PALM, "position": [0, 0, -0.02]}
    deep = {**moved, "position": [0, 0, -0.02]}
    assert overlap_messages(low, deep, ground={"height": -0.02}) == []
    assert overlap_messages(low, deep, others=bases[:1], ground={"height": -0.005}) == []
    assert overlap_messages(low, deep, others=bases[1:], ground={"height": -0.005}) == []


def test_two_manipulators_and_a_manipulator_in_the_ground() -> None:
    two = tuple(
        {"definition": BODY, "name": f"n{n}", "position": [0, 0.015 * n, 0]} for n in (0, 1)
    )
    (found,) = overlap_messages(others=two)
    assert found == "'n1' overlaps 'n0' by 2 mm at the start"
    free = {"definition": BODY, "name": "free", "base": "free", "position": [0, 0, 0.01]}
    assert overlap_messages(others=(free,), ground={}) == []


def test_a_scene_in_which_nothing_can_touch_asks_no_engine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "somo_cli.simulation.engine.bullet.world", None)
    document = loading.load_text(json.dumps({"manipulators": [{"definition": BODY}]}), "a.json")
    assert loading.overlaps(document) == ()


def test_without_an_engine_no_overlap_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    assert overlap_messages(PALM, CUBE) == []


@pytest.mark.moderate
def test_the_command_line_says_it_with_its_place(somo: Somo, tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(
        f"manipulators:\n  - {{definition: {json.dumps(BODY)}, position: [9, 9, 9]}}\n"
        f"objects:\n  - {json.dumps(PALM)}\n"
        f"  - {json.dumps({**CUBE, 'position': [0, 0, 0.02]})}\n"
    )
    checked = somo("check", "scene.yaml", cwd=tmp_path)
    assert (checked.returncode, checked.stdout) == (1, "")
    first = checked.stderr.splitlines()[0]
    assert first == "scene.yaml:5:103: error: 'cube' overlaps 'palm' by 10 mm at the start"
    run = somo("run", "scene.yaml", "--steps", "5", cwd=tmp_path)
    assert (run.returncode, run.stderr) == (3, checked.stderr)
    assert [one.name for one in tmp_path.iterdir()] == ["scene.yaml"]
