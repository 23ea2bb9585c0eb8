"""Patterns that match nothing, and names that could be two objects."""

from __future__ import annotations

from typing import Any

import pytest

from tests.builders.rigid_objects import CUBE, scene_of_objects
from tests.builders.scene_problems import messages_and_hints, messages_of


def record_problems(record: dict[str, Any], **of_scene: Any) -> list[tuple[str, str | None]]:
    scene = {**scene_of_objects(CUBE, **of_scene), "record": record}
    return messages_and_hints(scene)


def test_patterns_that_match() -> None:
    assert record_problems({"only": ["body.tip.*", "cube.pose.[xy]_m", "*.contact.body.*"]}) == []
    assert record_problems({"only": ["*"], "columns": [], "objects": ["angles"]}) == []


@pytest.mark.parametrize(
    ("record", "pattern", "hint"),
    [
        ({}, "body.tip.x", "did you mean 'body.tip.x_m'?"),
        ({}, "Cube.pose.z_m", "did you mean 'cube.pose.z_m'?"),
        ({}, "?", "names of columns look like 'body.actuator_0_joint_01.angle_rad'"),
        (
            {"columns": ["tip_position"]},
            "body.*.rate_rad_per_s",
            "it is a column of joint_rates: add joint_rates to record.columns",
        ),
        (
            {"objects": ["pose"]},
            "cube.contact.body.*",
            "it is a column of contact_pairs: add contact_pairs to record.objects",
        ),
    ],
)
def test_a_pattern_that_matches_nothing(record: dict[str, Any], pattern: str, hint: str) -> None:
    found = record_problems({**record, "only": ["*.x_m", pattern]})
    assert found == [(f"no column matches '{pattern}'", hint)]


def test_an_object_must_not_be_called_ground_beside_columns_of_contacts() -> None:
    other = {**CUBE, "name": "ground", "position": [1, 0, 0.02]}
    message = "an object is called ground, which is the ground's name in contacts"
    for record in ({"objects": ["contact_pairs"]}, {"events": True}):
        scene = {**scene_of_objects(CUBE, other, ground={}), "record": record}
        assert messages_of(scene) == [message]
        # without a ground, or without columns of contacts, it may be called so
        del scene["ground"]
        assert messages_of(scene) == []
    scene = {**scene_of_objects(CUBE, other, ground={}), "record": {}}
    assert messages_of(scene) == []
