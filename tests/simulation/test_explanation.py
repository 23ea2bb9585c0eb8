"""What a plan leaves out, and that leaving it out changes nothing."""

from __future__ import annotations

import dataclasses
import json

import pytest

from somo_cli.simulation.explanation import explain, plain
from somo_cli.simulation.plan import Plan, make_plan
from tests.loading import DEFINITIONS, rows_of, scene_from_file, scene_from_text
from tests.manipulator.bodies import X, actuator, manipulator

ALONE = {"manipulators": [{"definition": manipulator(actuator(2, X))}]}
CUBE = {"name": "cube", "shape_type": "box", "dimensions": [0.1, 0.1, 0.1], "mass": 1}
SCENES = sorted(path.name for path in DEFINITIONS.glob("*scene.yaml"))


def decided(**changes: object) -> dict[str, tuple[bool, str]]:
    plan = make_plan(scene_from_text(json.dumps(ALONE | changes)))
    return {one.what: (one.is_kept, one.why) for one in explain(plan)}


def test_of_one_manipulator_alone_nearly_all_is_left_out() -> None:
    kept = {what for what, (is_kept, _) in decided().items() if is_kept}
    assert kept == {"joint limits", "recorded state"}


def test_each_reason_is_that_of_the_scene() -> None:
    found = decided(
        ground={},
        objects=[CUBE | {"position": [9, 9, 9], "restitution": 0.5}],
        stop=[{"time": 1}],
        record={"every": 5, "columns": ["energy"], "objects": ["contact_force"]},
    )
    assert found["collision shapes"] == (True, "1 manipulator, 1 object, the ground can touch")
    assert found["engine parameters for rebounds"] == (True, "a restitution is above 0")
    assert found["contact points of recorded steps"] == (True, "columns need them")
    assert found["the step after a recorded one, by itself"] == (True, "columns need velocities")
    assert found["looks at what ends the run"] == (True, "1 condition of stop")
    assert found["recorded state"] == (True, "contact_force, energy, every 5 steps")
    assert found["collisions within a manipulator"] == (False, "self_collision is off")


def test_a_line_says_what_and_why() -> None:
    lines = [str(one) for one in explain(make_plan(scene_from_text(json.dumps(ALONE))))]
    assert lines[0].startswith("left out  collision shapes: one manipulator, no ground")
    assert plain(make_plan(scene_from_text(json.dumps(ALONE))))[1] == {
        "what": "visual shapes",
        "kept": False,
        "why": "nothing is rendered",
    }


def plan_of(name: str, keeps_everything: bool) -> Plan:
    return make_plan(dataclasses.replace(scene_from_file(name), every=1), keeps_everything)


@pytest.mark.parametrize("name", SCENES)
def test_leaving_out_changes_no_byte(name: str) -> None:
    pytest.importorskip("pybullet")
    steps = 20 if name == "crawler_scene.yaml" else 60
    lean, whole = plan_of(name, False), plan_of(name, True)
    assert "<visual>" in whole.bodies[0].urdf
    assert "<collision>" in whole.bodies[0].urdf
    assert ("<collision>" in lean.bodies[0].urdf) is lean.can_touch
    assert rows_of(lean, steps) == rows_of(whole, steps)
