"""Errors over time by quantity, and what is extrapolate from three levels."""

from __future__ import annotations

import json

import numpy as np
import pytest

from somo_cli.analysis.errors import align_quaternions, error_profiles, summarize_errors
from somo_cli.analysis.reference import extrapolate
from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.scenes import scene_from_text

QUANTITIES = ["tip_position", "joint_angles", "energy", "base_pose", "link_orientations"]


def plan_of_two() -> Plan:
    definition = manipulator(actuator(2, X))
    two = [{"name": name, "definition": definition} for name in ("a", "b")]
    text = json.dumps({"manipulators": two, "record": {"columns": QUANTITIES}})
    return make_plan(scene_from_text(text))


def rows_with(changes: dict[str, float], time: float = 0.0) -> np.ndarray:
    names = columns.header(plan_of_two().recorded)
    row = [1.0 if name.endswith(".qw") else 0.0 for name in names]
    for name, value in changes.items():
        row[names.index(name)] = value
    row[0] = time
    return np.array([row])


def test_every_quantity_has_its_own_measure() -> None:
    plan, reference = plan_of_two(), rows_with({})
    rows = rows_with(
        {
            "a.tip.x_m": 0.3,
            "a.tip.z_m": -0.4,
            "b.tip.y_m": 0.1,
            "a.actuator_0_joint_01.angle_rad": 0.02,
            "b.actuator_0_joint_02.angle_rad": -0.03,
            "a.energy.kinetic_j": 0.5,
            "a.energy.gravity_j": -0.2,
            "b.base_pose.x_m": 0.07,
            "b.base_pose.qw": -1.0,
            "a.base.qw": -1.0,
            "b.actuator_0_segment_01.qx": 0.01,
        }
    )
    found = {name: float(error[0]) for name, error in error_profiles(plan, rows, reference).items()}
    assert found == pytest.approx(
        {
            "tip_position": 0.5,
            "joint_angles": 0.03,
            "energy": 0.3,
            "base_pose": 0.07,
            "link_orientations": 0.01,
        }
    )


def test_opposite_quaternions_are_one_rotation() -> None:
    reference = np.array([[0.0, 0.6, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0]])
    found = align_quaternions(
        "link_orientations", reference * [-1, -1, -1, -1, 1, 1, 1, 1], reference
    )
    assert np.array_equal(found, reference)


def test_an_error_has_an_end_a_maximum_and_a_mean() -> None:
    error = summarize_errors(np.array([0.0, 3.0, 4.0, 1.0]))
    assert (error.final, error.maximum) == (1.0, 4.0)
    assert error.rms == pytest.approx(np.sqrt(26 / 4))


@pytest.mark.parametrize("order", [1.0, 1.6, 2.0])
def test_the_limit_of_three_levels_is_found(order: float) -> None:
    """y(h) = y + c h^p + d h^(p + 2): the limit is nearer than its own error says."""
    plan, exact = plan_of_two(), rows_with({"a.tip.x_m": 0.5})
    levels = []
    for step in (0.4, 0.2, 0.1):
        off = 0.1 * step**order + 0.02 * step ** (order + 2)
        levels.append(rows_with({"a.tip.x_m": 0.5 + off, "b.tip.x_m": 0.5 * off}))
    found = extrapolate(plan, levels, 2.0)
    off = error_profiles(plan, found.rows, exact)["tip_position"].max()
    assert found.order["tip_position"] == pytest.approx(order, abs=0.2)
    assert 0 < off <= found.error["tip_position"] < 0.5 * 0.1 * 0.1**order
    assert found.final_error == found.error
    assert found.error["joint_angles"] == 0.0


def test_where_no_order_is_seen_the_finest_stands() -> None:
    plan = plan_of_two()
    levels = [rows_with({"a.tip.x_m": value}) for value in (0.0, 0.1, 0.3)]
    found = extrapolate(plan, levels, 2.0)
    assert np.array_equal(found.rows, levels[2])
    assert found.error["tip_position"] == pytest.approx(0.2)
