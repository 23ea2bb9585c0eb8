"""A manipulator that starts at its springs' neutral shape stays there, and the shape is right."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import numpy as np
import pytest

import somo_cli
from somo_cli import loading
from somo_cli.analysis.scene_variants import with_segments
from somo_cli.scene.model import Scene
from tests.builders.definitions import X, Y, actuator, hinge, manipulator

pytest.importorskip("pybullet")

BENT = hinge(1, 0, 0, joint_neutral_position=0.3)
TURNED = hinge(0, 1, 0, joint_neutral_position=-0.1)
BODY = manipulator(actuator(4, BENT, TURNED), actuator(3, hinge(1, 0, 0)), actuator(2, Y))
NEUTRAL = (0.3, -0.1, 0.3, -0.1, 0.0, 0.0, 0.0, 0.0, 0.0)


def text_of(body: dict[str, Any] = BODY, **changes: Any) -> str:
    one = {"definition": body, "initial_angles": "neutral", **changes}
    record = {"columns": ["joint_angles", "joint_rates", "energy", "tip_position"]}
    return json.dumps({"gravity": [0, 0, 0], "manipulators": [one], "record": record})


def scene_of(text: str) -> Scene:
    return loading.scene_of(loading.load_text(text, "a.json"))[0]


def test_every_joint_starts_at_its_own_neutral_position() -> None:
    assert scene_of(text_of()).manipulators[0].initial_angles == NEUTRAL
    straight = scene_of(text_of(manipulator(actuator(3, X)))).manipulators[0]
    assert straight.initial_angles == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("base", ["static", "free", "constrained"])
@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_nothing_moves_without_gravity_and_actuation(integrator: str, base: str) -> None:
    document = loading.load_text(text_of(base=base), "a.json", [f"integrator={integrator}"])
    result = somo_cli.simulate(document, 300, time_step=1e-3 if integrator != "explicit" else 2e-5)
    # the explicit law is 0 there to the last bit, the others to what eigenvectors round
    is_exact = integrator == "explicit" or base == "free"
    for suffix, rounding in (("angle_rad", 1e-14), ("rate_rad_per_s", 1e-11), ("_j", 1e-28)):
        moved = [np.ptp(result[name]) for name in result.names if name.endswith(suffix)]
        assert max(moved) <= (0 if is_exact else rounding), suffix
    assert [result[name][0] for name in result.names if name.endswith("angle_rad")] == list(NEUTRAL)


def test_it_moves_where_it_does_not_start_so() -> None:
    result = somo_cli.simulate(loading.load_text(text_of(initial_angles=0), "a.json"), 300)
    moved = [np.ptp(result[name]) for name in result.names if name.endswith("angle_rad")]
    assert max(moved) > 0.5


def test_the_tip_is_where_an_arc_ends() -> None:
    """With n equal bends the tip is that of the polygon whose sides turn by one bend each."""
    body = manipulator(actuator(4, hinge(1, 0, 0, joint_neutral_position=0.3)))
    result = somo_cli.simulate(loading.load_text(text_of(body), "a.json"), 1)
    # joints in the middle of 4 segments of 20 mm, so 5 sides: 10, 20, 20, 20 and 10 mm
    sides = [(0.01, 0), (0.02, 1), (0.02, 2), (0.02, 3), (0.01, 4)]
    y = -sum(side * math.sin(0.3 * turns) for side, turns in sides)
    z = sum(side * math.cos(0.3 * turns) for side, turns in sides)
    tip = [result[f"body.tip.{axis}_m"][0] for axis in "xyz"]
    assert tip == pytest.approx([0, y, z], abs=1e-12)


def test_an_assembly_starts_limb_by_limb_so() -> None:
    assembly = {
        "assembly_name": "hand",
        "body_definition": {"shape_type": "box", "dimensions": [0.1, 0.1, 0.1], "mass": 1},
        "limbs": [
            {"name": "one", "definition": BODY, "position": [0, 0, 0.1]},
            {"name": "two", "definition": manipulator(actuator(2, BENT)), "position": [0, 0, 0]},
        ],
    }
    assert scene_of(text_of(assembly)).manipulators[0].initial_angles == (*NEUTRAL, 0.3, 0.3)


def test_a_chain_of_more_segments_starts_at_its_own_neutral_shape() -> None:
    body = manipulator(actuator(5, hinge(1, 0, 0, joint_neutral_position=0.3)))
    whole = scene_of(text_of(body))
    finer = with_segments(whole, 7).manipulators[0]
    assert finer.initial_angles == finer.compiled.chain.neutral_angles
    assert sum(finer.initial_angles) == pytest.approx(1.5)
    assert dataclasses.replace(whole, manipulators=(finer,)).manipulators[0] == finer


def test_a_neutral_position_outside_the_limits_is_an_error_with_its_place() -> None:
    away = hinge(1, 0, 0, joint_neutral_position=0.5, limits=[-0.2, 0.2, 1, 1])
    text = text_of(manipulator(actuator(3, away), actuator(2, Y), actuator(2, away)))
    found = loading.check(loading.load_text(text, "a.json"))
    assert [one.message for one in found] == [
        f"joint 'actuator_{number}_joint_01' starts at its neutral position, 0.5 rad, outside its "
        "limits [-0.2, 0.2]"
        for number in (0, 2)
    ]
    assert {text[one.span.column - 1 :][: one.span.width] for one in found} == {'"neutral"'}


@pytest.mark.parametrize("value", ["straight", "", "Neutral"])
def test_no_other_word_is_taken(value: str) -> None:
    found = loading.check(loading.load_text(text_of(initial_angles=value), "a.json"))
    (message,) = {one.message for one in found}
    assert message.endswith("is neither a number, nor a list of numbers, nor neutral")


def test_a_neutral_shape_in_the_ground_is_seen() -> None:
    """Bent over by 1.2 rad in each of three joints, it reaches below its base."""
    body = manipulator(actuator(4, hinge(1, 0, 0, joint_neutral_position=1.2)))
    one = {"definition": body, "position": [0, 0, 0.02]}
    for angles, count in ((0, 0), ("neutral", 1)):
        scene = {"ground": {}, "manipulators": [{**one, "initial_angles": angles}]}
        found = loading.check(loading.load_text(json.dumps(scene), "a.json"))
        assert [" inside the ground" in problem.message for problem in found] == [True] * count
