"""What a plan leaves out, and that leaving it out changes nothing."""

from __future__ import annotations

import dataclasses
import itertools
import json

import numpy as np
import pytest

from somo_cli.manipulator import urdf
from somo_cli.simulation.decision import Decision
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan_report import explain, plain_data
from tests.builders.definitions import Data, X, Y, actuator, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import DEFINITIONS, scene_from_file, scene_from_text

ALONE = {"manipulators": [{"definition": manipulator(actuator(2, X))}]}
CUBE = {"name": "cube", "shape_type": "box", "dimensions": [0.1, 0.1, 0.1], "mass": 1}
SCENES = sorted(path.name for path in DEFINITIONS.glob("*scene.yaml"))


def explained(**changes: object) -> dict[str, Decision]:
    plan = make_plan(scene_from_text(json.dumps(ALONE | changes)))
    return {one.what: one for one in explain(plan)}


def decided(**changes: object) -> dict[str, tuple[bool, str]]:
    return {what: (one.is_kept, one.why) for what, one in explained(**changes).items()}


def saved(**changes: object) -> dict[str, str]:
    return {what: one.saves for what, one in explained(**changes).items() if one.saves}


def test_of_one_manipulator_alone_nearly_all_is_left_out() -> None:
    kept = {what for what, (is_kept, _) in decided().items() if is_kept}
    assert kept == {"iterations of the solver", "recorded state"}


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
    assert found["velocities of the step after a row"] == (True, "columns need velocities")
    assert found["checks of stop conditions"] == (True, "1 stop condition")
    assert found["recorded state"] == (True, "contact_force, energy, every 5 steps")
    assert found["collisions within a manipulator"] == (False, "self_collision is off")
    within = "2 joints with limits, a row only beyond one"
    assert found["joint limits in the engine"] == (True, within)


def test_a_line_says_what_and_why() -> None:
    lines = [str(one) for one in explain(make_plan(scene_from_text(json.dumps(ALONE))))]
    assert lines[0].startswith("left out  collision shapes: one manipulator, no ground")
    assert plain_data(make_plan(scene_from_text(json.dumps(ALONE))))[1] == {
        "what": "visual shapes",
        "kept": False,
        "why": "nothing is rendered",
        "saves": "3 shapes",
    }


def test_what_is_saved_of_one_manipulator_alone() -> None:
    assert saved(record={"every": 5, "columns": ["joint_angles"]}) == {
        "collision shapes": "3 shapes to move in every step",
        "visual shapes": "3 shapes",
        "motor rows of joints": "2 rows in every step",
        "joint limits in the engine": "2 constraints in every step",
        "inertia of the joints in every step": (
            "inertia and inverse, 2 x 2, of 1 body in all others"
        ),
        # 4 of each joint, 3 + 4 of each link's pose, 7 of the base's, 3 of the tip, 3 energies,
        # 1 axis, and of contact 4 in all and 8 of each link
        "recorded state": "77 of 79 columns in every row and all of them in 4 of 5 steps",
        "velocities of the step after a row": "a step beyond the last row",
        "checks of stop conditions": "one check every 8 steps",
    }


def test_nothing_is_saved_where_all_is_needed() -> None:
    joint = X | {"joint_control_limit_force": 0.01}
    rubbing = {"manipulators": [{"definition": manipulator(actuator(2, joint))}]}
    everything = {"every": 1, "only": ["*"]}
    assert saved(**rubbing, record=everything, stop=[{"time": 1}]).keys() == {
        "collision shapes",
        "visual shapes",
        "joint limits in the engine",
        "inertia of the joints in every step",
    }


def test_motor_rows_are_kept_where_asked_for() -> None:
    what = "motor rows of joints"
    rubbing = X | {"joint_control_limit_force": 0.01}

    def reported(*joints: Data) -> list[Decision]:
        data = {"manipulators": [{"definition": manipulator(actuator(2, *joints))}]}
        scene = scene_from_text(json.dumps(data))
        plans = (make_plan(scene, is_whole) for is_whole in (False, True))
        return [one for plan in plans for one in explain(plan) if one.what == what]

    assert reported(X) == [
        Decision(what, False, "no dry friction", "2 rows in every step"),
        Decision(what, True, "asked for, though no dry friction"),
    ]
    of_one = "dry friction of 1 joint, one row each"
    assert reported(X, rubbing) == [
        Decision(what, True, of_one, "1 row in every step"),
        Decision(what, True, f"{of_one}, asked for of 1 more"),
    ]
    of_all = "dry friction of 2 joints, one row each"
    assert reported(rubbing) == [Decision(what, True, of_all)] * 2


def test_limits_are_kept_where_needed_or_asked_for() -> None:
    what = "joint limits in the engine"

    def reported(keeps_unused: bool, **more: object) -> str:
        scene = scene_from_text(json.dumps(ALONE | more))
        plan = make_plan(scene, keeps_unused)
        return next(one.why for one in explain(plan) if one.what == what)

    within = "2 joints with limits, a row only beyond one"
    assert reported(False) == "2 joints with limits, at which the law stops them"
    assert reported(True) == f"{within}, asked for, though the law stops them"
    assert reported(False, ground={}) == reported(True, ground={}) == within
    assert reported(False, integrator="explicit") == reported(True, integrator="explicit") == within


def test_pairs_that_are_spared_are_counted() -> None:
    one = {"definition": manipulator(actuator(4, X))}
    two = {**one, "name": "a", "self_collision": True}, {**one, "name": "b", "position": [9, 0, 0]}
    found = saved(manipulators=two, ground={"height": -9})
    # neighbours of one, all five links of the other; two bases and the ground
    assert found["collisions within a manipulator"] == "at least 14 pairs of links"
    assert found["collisions between fixed bodies"] == "3 pairs"
    free = [{**one, "base": "free"}]
    assert "collisions between fixed bodies" not in explained(
        manipulators=free, ground={"height": -9}
    )


def test_links_that_are_merged_are_counted() -> None:
    what = "links joined by fixed joints"
    assert decided()[what] == (False, "every link is one solid")
    plan = make_plan(scene_from_file("hand_scene.yaml"))
    (hand,) = plan.bodies
    (merged,) = [one for one in explain(plan) if one.what == what]
    bare = urdf.render_for_engine(hand.chain, with_collisions=True)
    spared = bare.count("<collision>") - bare.count("<link ")
    assert merged.saves == f"{spared} links and as many fixed joints"
    assert spared > 5


def plan_with_rows_between_checks(name: str, keeps_unused: bool) -> Plan:
    # rows between two checks, which are at every eighth step
    return make_plan(dataclasses.replace(scene_from_file(name), every=3), keeps_unused)


def without_motors(plan: Plan) -> Plan:
    bodies = (dataclasses.replace(body, has_zero_torque_motors=False) for body in plan.bodies)
    return dataclasses.replace(plan, bodies=tuple(bodies))


def bits(plan: Plan, steps: int) -> list[list[str]]:
    return [[value.hex() for value in row] for row in rows_of(plan, steps)]


@pytest.mark.moderate
@pytest.mark.parametrize("name", SCENES)
def test_leaving_out_changes_no_byte(name: str) -> None:
    """Without motor rows and with them: what is left out in pairs cannot make up for itself."""
    pytest.importorskip("pybullet")
    steps = 20 if name == "crawler_scene.yaml" else 60
    lean, whole = (
        plan_with_rows_between_checks(name, False),
        plan_with_rows_between_checks(name, True),
    )
    assert "<visual>" in whole.bodies[0].urdf
    assert "<collision>" in whole.bodies[0].urdf
    assert ("<collision>" in lean.bodies[0].urdf) is lean.can_touch
    assert all("<visual>" in one_object.urdf for one_object in whole.objects if one_object.urdf)
    assert all(body.has_zero_torque_motors and body.has_engine_limits for body in whole.bodies)
    least = bits(lean, steps)
    assert bits(without_motors(whole), steps) == least
    assert bits(whole, steps) == least


def test_a_motor_row_moves_what_is_exactly_at_rest_and_next_to_nothing() -> None:
    """A straight body in free fall: its joints feel rounding, which now and then is nothing."""
    pytest.importorskip("pybullet")
    one = {"definition": manipulator(actuator(6, X)), "base": "free"}
    data = {
        "manipulators": [one],
        "gravity": [0, 9.81, 0],
        "integrator": "euler",
        "record": {"columns": ["joint_angles", "joint_rates"]},
    }
    scene = scene_from_text(json.dumps(data))
    lean, whole = (rows_of(make_plan(scene, is_whole), 150) for is_whole in (False, True))
    pairs = zip(itertools.chain(*lean), itertools.chain(*whole), strict=True)
    moved = [(least, most) for least, most in pairs if least != most]
    assert moved
    assert {least for least, _ in moved} == {0.0}
    assert max(abs(most) for _, most in moved) < 1e-290


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
def test_limits_in_the_engine_change_an_impact_by_less_than_the_step_does(integrator: str) -> None:
    """The law lets a joint that strikes beyond its limit by a little; the engine pushes it back."""
    pytest.importorskip("pybullet")
    x, y = (joint | {"limits": [-0.2, 0.2, 10, 20], "spring_stiffness": 0.02} for joint in (X, Y))
    one = {"definition": manipulator(actuator(6, x, y), world_scale=20)}

    def angles(step: float, is_whole: bool) -> np.ndarray:
        data = {
            "manipulators": [one],
            "gravity": [30, 50, 0],
            "integrator": integrator,
            "time_step": step,
            "record": {"every": round(4e-3 / step), "columns": ["joint_angles"]},
        }
        plan = make_plan(scene_from_text(json.dumps(data)), is_whole)
        return np.array(rows_of(plan, round(0.4 / step)))[:, 1:]

    lean, whole, halved = angles(4e-3, False), angles(4e-3, True), angles(2e-3, False)
    assert 0 < lean.max() - 0.2 < 1e-4
    difference = np.abs(whole - lean).max()
    assert 0 < difference < 1e-4
    assert difference < 0.01 * np.abs(halved - lean).max()
