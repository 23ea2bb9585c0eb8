"""Patterns that match nothing, and names that could be two objects."""

from __future__ import annotations

import json
from typing import Any

import pytest

from somo_cli.document.parse import parse
from somo_cli.scene.checks import scene as scene_checks
from tests.builders.rigid_objects import CUBE, scene_of


def told(record: dict[str, Any], **of_scene: Any) -> list[tuple[str, str | None]]:
    scene = {**scene_of(CUBE, **of_scene), "record": record}
    return [
        (one.message, one.hint)
        for one in scene_checks.scene_problems(parse(json.dumps(scene), "a.json"))
    ]


def test_patterns_that_match() -> None:
    assert told({"only": ["body.tip.*", "cube.pose.[xy]_m", "*.contact.body.*"]}) == []
    assert told({"only": ["*"], "columns": [], "objects": ["angles"]}) == []


@pytest.mark.parametrize(
    ("record", "pattern", "hint"),
    [
        ({}, "body.tip.x", "did you mean 'body.tip.x_m'?"),
        ({}, "Cube.pose.z_m", "did you mean 'cube.pose.z_m'?"),
        ({}, "?", "columns are called like 'body.actuator_0_joint_01.angle_rad'"),
        (
            {"columns": ["tip_position"]},
            "body.*.rate_rad_per_s",
            "it is among joint_rates, which record.columns does not list",
        ),
        (
            {"objects": ["pose"]},
            "cube.contact.body.*",
            "it is among contact_pairs, which record.objects does not list",
        ),
    ],
)
def test_a_pattern_that_matches_nothing(record: dict[str, Any], pattern: str, hint: str) -> None:
    found = told({**record, "only": ["*.x_m", pattern]})
    assert found == [(f"no column matches '{pattern}'", hint)]


def test_the_ground_is_not_told_from_an_object_of_its_name() -> None:
    other = {**CUBE, "name": "ground", "position": [1, 0, 0.02]}
    message = "an object is called ground, as is the ground in columns of contacts"
    for record in ({"objects": ["contact_pairs"]}, {"events": True}):
        scene = {**scene_of(CUBE, other, ground={}), "record": record}
        (found,) = scene_checks.scene_problems(parse(json.dumps(scene), "a.json"))
        assert found.message == message
        # without a ground, or without columns of contacts, it may be called so
        del scene["ground"]
        assert scene_checks.scene_problems(parse(json.dumps(scene), "a.json")) == ()
    scene = {**scene_of(CUBE, other, ground={}), "record": {}}
    assert scene_checks.scene_problems(parse(json.dumps(scene), "a.json")) == ()
