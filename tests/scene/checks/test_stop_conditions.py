"""What is wrong with conditions that end a run."""

from __future__ import annotations

from typing import Any

import pytest

from tests.builders.rigid_objects import BALL, CUBE, scene_of_objects
from tests.builders.scene_problems import messages_and_hints

BOX = {"z": [0, 1]}


def stop_problems(*conditions: Any) -> list[tuple[str, str | None]]:
    table = {**CUBE, "name": "table", "fixed": True, "position": [0, 0, -0.02]}
    scene = scene_of_objects(CUBE, BALL, table, stop=list(conditions))
    return messages_and_hints(scene)


def test_what_is_right() -> None:
    assert stop_problems() == []
    assert stop_problems({"time": 1}, {"at_rest": {}}, {"object": "cube", "leaves": BOX}) == []


@pytest.mark.parametrize(
    ("condition", "message", "hint"),
    [
        ({}, "missing a condition", "give time: 2.0, or object: NAME"),
        ({"object": "cube"}, "missing leaves, the box of the object", "give time"),
        (
            {"leaves": BOX},
            "missing object: the name of the object that leaves the box",
            "the objects are cube",
        ),
        ({"time": 1, "at_rest": {}}, "time and at_rest are 2 conditions in one entry", "give each"),
        ({"time": 1, "object": "cube"}, "object has no meaning beside time", "leave it out"),
        ({"object": "cub", "leaves": BOX}, "there is no object 'cub'", "did you mean 'cube'?"),
        ({"object": "q", "leaves": BOX}, "there is no object 'q'", "the objects are cube, ball"),
        ({"object": "table", "leaves": BOX}, "'table' is fixed, so it never leaves", "name one"),
        (
            {"object": "cube", "leaves": {"z": [1, 0]}},
            "the range from 1 to 0 is empty",
            "give the lower",
        ),
        (
            {"object": "cube", "leaves": {"x": [1, 1]}},
            "the range from 1 to 1 is empty",
            "give the lower",
        ),
        (
            {"object": "cube", "leaves": {"x": [1, 2]}},
            "'cube' starts outside the box, at x = 0 m: the run would end before its first step",
            "widen the box",
        ),
    ],
)
def test_what_is_wrong(condition: dict[str, Any], message: str, hint: str) -> None:
    ((found, advice),) = stop_problems({"time": 3}, condition)
    assert found == message
    assert advice is not None
    assert advice.startswith(hint)


@pytest.mark.parametrize(
    "condition",
    [
        {"time": 0},
        {"time": -1},
        {"at_rest": {"for": 0}},
        {"at_rest": {"speed": 0}},
        {"at_rest": {"rate": -1}},
        {"at_rest": {"after": -1}},
        {"object": "cube", "leaves": {}},
        {"object": "cube", "leaves": {"z": [1]}},
        {"object": "cube", "leaves": {"w": [0, 1]}},
    ],
)
def test_what_the_schema_refuses(condition: dict[str, Any]) -> None:
    assert len(stop_problems(condition)) == 1
