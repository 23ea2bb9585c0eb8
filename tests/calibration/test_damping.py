"""Damping from a ratio: the mode it damps, against eigenvalues and a simulated ring-down."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from somo_cli.calibration.damping import NoMode, lowest_mode
from somo_cli.calibration.ring_down import ring_down
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import Data, X, Y, actuator, hinge, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text


def plan_of_actuators(*actuators: Data, **of_scene: Any) -> Plan:
    data = {"gravity": [0, 0, 0], "manipulators": [{"definition": manipulator(*actuators)}]}
    return make_plan(scene_from_text(json.dumps({**data, **of_scene})))


@pytest.mark.parametrize(("axis", "frequency"), [(0, 15.66), (1, 34.40)])
def test_the_modes_of_the_shipped_finger(axis: int, frequency: float) -> None:
    found = lowest_mode(make_plan(scene_from_file("scene.yaml", "gravity=[0,0,0]")), 0, 0, axis)
    assert found.frequency == pytest.approx(frequency, rel=3e-4)
    assert found.ratio == pytest.approx(0.03, rel=0.01)
    assert found.seconds * 1 / found.per_ratio == pytest.approx(0.03, rel=0.01)
    # alone in its axis, a mode has c = 2 ζ / ω
    assert found.share == pytest.approx(1)
    assert found.per_ratio == pytest.approx(2 / found.frequency, rel=1e-6)


def test_a_mode_that_two_axes_share_counts_its_own() -> None:
    # hinges off the centre couple bending and torsion
    bend = hinge(1, 0, 0, neutral_axis_offset=[0.01, 0, 0, 0, 0, 0])
    joints = bend, hinge(0, 0, 1, spring_stiffness=0.01)
    plain = plan_of_actuators(actuator(6, *joints))
    for axis in (0, 1):
        mode = lowest_mode(plain, 0, 0, axis)
        seconds = 0.07 * mode.per_ratio
        damped = [
            one | {"spring_damping": seconds * one["spring_stiffness"] if n == axis else 0}
            for n, one in enumerate(joints)
        ]
        again = lowest_mode(plan_of_actuators(actuator(6, *damped)), 0, 0, axis)
        assert again.ratio == pytest.approx(0.07, rel=1e-9)


def test_gravity_softens_what_stands_and_may_topple_it() -> None:
    one = actuator(4, X, Y)
    standing = plan_of_actuators(one, gravity=[0, 0, -9.81])
    assert (
        lowest_mode(standing, 0, 0, 0).frequency
        < lowest_mode(plan_of_actuators(one), 0, 0, 0).frequency
    )
    with pytest.raises(NoMode, match="gravity topples it"):
        lowest_mode(plan_of_actuators(one, gravity=[0, 0, -9810.0]), 0, 0, 0)


def test_of_several_actuators_the_others_are_locked() -> None:
    three = plan_of_actuators(actuator(4, X, Y), actuator(4, X, Y), actuator(4, X, Y))
    found = lowest_mode(three, 0, 1, 0)
    assert found.is_alone
    # the same with the others so stiff that they do not move
    stiff = [hinge(*axis, spring_stiffness=1e6) for axis in ((1, 0, 0), (0, 1, 0))]
    alone = plan_of_actuators(actuator(4, *stiff), actuator(4, X, stiff[1]), actuator(4, *stiff))
    assert found.frequency == pytest.approx(lowest_mode(alone, 0, 1, 0).frequency, rel=1e-4)
    assert found.per_ratio == pytest.approx(2 / found.frequency)
    assert found.ratio == pytest.approx(found.seconds / found.per_ratio)


def test_without_springs_there_is_no_mode() -> None:
    limp = hinge(1, 0, 0, spring_stiffness=0)
    with pytest.raises(NoMode, match="no spring_stiffness"):
        lowest_mode(plan_of_actuators(actuator(2, limp, Y)), 0, 0, 0)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.02, 0.2])
def test_a_simulated_finger_rings_down_with_its_damping_ratio(ratio: float) -> None:
    pytest.importorskip("pybullet")
    bare = plan_of_actuators(actuator(8, X, Y))
    mode = lowest_mode(bare, 0, 0, 0)
    joint = X | {"spring_damping": ratio * mode.per_ratio * X["spring_stiffness"]}
    body = {"definition": manipulator(actuator(8, joint, Y | {"spring_damping": 0.01}))}
    # let go out of the shape that a small force on the tip bends it into, near the first mode
    arms = np.arange(8)[::-1] + 0.5
    angles = np.where(np.arange(8) % 2 == 0, 1e-3 * arms, 0.0).tolist()
    scene = {
        "gravity": [0, 0, 0],
        "time_step": 2e-4,
        "manipulators": [body | {"initial_angles": angles}],
        "record": {"every": 5, "columns": ["tip_position"]},
    }
    rows = np.array(rows_of(scene_from_text(json.dumps(scene)), 5000))
    late = rows[:, 0] > 0.1  # when faster modes have gone
    found = ring_down(rows[late, 0], rows[late, 2])
    assert found.frequency == pytest.approx(mode.frequency, rel=2e-3)
    assert found.ratio == pytest.approx(ratio, rel=1e-2)
    assert found.decay == pytest.approx(ratio * mode.frequency, rel=1e-2)
    assert math.isfinite(found.ratio_error)
