"""How far two runs are apart: by what each column is judged, and against what."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.analysis.column_families import column_families, force_columns, unit_of
from somo_cli.analysis.column_scales import LEAST_ANGLE, LEAST_SHARE, scales
from somo_cli.analysis.impulses import RowsWithImpulses, sampled_plan, width_with_impulses
from somo_cli.analysis.level_comparison import DifferenceAccumulator
from somo_cli.scene import columns
from somo_cli.scene.model import ALL_OBJECT_QUANTITIES, ALL_QUANTITIES
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file

PUSH = scene_from_file("push_scene.yaml")


def plan_of(**changes: object) -> Plan:
    return make_plan(dataclasses.replace(PUSH, **changes))  # type: ignore[arg-type]


EVERYTHING = plan_of(columns=ALL_QUANTITIES, object_quantities=ALL_OBJECT_QUANTITIES)


def test_every_column_is_in_one_family_of_its_unit() -> None:
    names = columns.header(EVERYTHING.recorded)
    found = [column for one in column_families(EVERYTHING.recorded) for column in one.columns]
    assert sorted(found) == list(range(1, len(names)))
    units = {unit_of(name) for name in names[1:]}
    assert units == {"m", "rad", "rad/s", "m/s", "N", "N·m", "J", "1/m", "1"}


def test_what_jumps_at_an_impact_is_judged_by_a_mean_and_forces_by_impulses() -> None:
    measures = {(one.name, one.unit): one.measure for one in column_families(EVERYTHING.recorded)}
    assert measures["finger joint_angles", "rad"] == "largest"
    assert measures["cube pose", "m"] == "largest"
    assert measures["cube pose", "1"] == "largest"
    assert measures["finger joint_rates", "rad/s"] == "mean"
    assert measures["finger energy", "J"] == "mean"
    assert measures["cube velocity", "m/s"] == "mean"
    assert measures["cube velocity", "rad/s"] == "mean"
    assert measures["cube contact_force", "N"] == "impulse"
    assert measures["finger contact_pairs", "N"] == "impulse"


def places_of(plan: Plan, *names: str) -> list[int]:
    header = columns.header(plan.recorded)
    return [header.index(name) for name in names]


def two_runs(plan: Plan, count: int = 1001) -> tuple[np.ndarray, np.ndarray]:
    """Return rows of two runs over one second in which nothing happens."""
    rows = np.zeros((count, width_with_impulses(plan)))
    rows[:, 0] = np.linspace(0, 1, count)
    for part in columns.quaternion_columns(plan.recorded):
        rows[:, part[-1]] = 1
    return rows, rows.copy()


def test_an_impact_that_comes_a_millisecond_early_counts_a_thousandth() -> None:
    """Of its jump in velocity, and of its impulse; the largest errors are the whole jump."""
    plan = plan_of(object_quantities=("velocity", "contact_force"), columns=("joint_angles",))
    early, late = two_runs(plan)
    (speed, force) = places_of(plan, "cube.velocity.x_m_per_s", "cube.contact.fx_n")
    impulse = len(columns.header(plan.recorded)) + force_columns(plan.recorded).index(force)
    for rows, instant in ((early, 500), (late, 501)):
        rows[instant:, speed] = 0.2  # m/s
        rows[instant, force] = 2.0  # N in one step of 1 ms, so 2 mN·s
        rows[instant:, impulse] = 2e-3
    pair = DifferenceAccumulator(plan)
    for first in range(0, 1001, 100):  # in blocks, as a run writes them
        pair.add(early[first : first + 100], late[first : first + 100])
    found = pair.differences()
    assert found.largest[speed - 1] == 0.2
    assert found.judged[speed - 1] == pytest.approx(0.2 / 1001)
    assert found.judged[force - 1] == pytest.approx(2e-3 / 1001)
    assert found.range[force - 1] == pytest.approx(2e-3)
    relative = found.judged / np.where(found.range > 0, found.range, 1)
    assert relative[speed - 1] == pytest.approx(1e-3, rel=0.01)
    assert relative[force - 1] == pytest.approx(1e-3, rel=0.01)


def test_a_steady_force_that_is_off_by_a_hundredth_is_off_by_a_hundredth() -> None:
    plan = plan_of(columns=("contact_force",), object_quantities=())
    rows, finer = two_runs(plan)
    (force,) = places_of(plan, "finger.contact.fz_n")
    impulse = len(columns.header(plan.recorded)) + force_columns(plan.recorded).index(force)
    for run, size in ((rows, 3.03), (finer, 3.0)):
        run[:, force] = size
        run[:, impulse] = size * run[:, 0]
    pair = DifferenceAccumulator(plan)
    pair.add(rows, finer)
    found = pair.differences()
    assert found.judged[force - 1] == pytest.approx(0.03)  # N
    assert found.judged[force - 1] / found.range[force - 1] == pytest.approx(0.01, rel=0.01)


def test_the_sign_of_a_quaternion_is_neither_an_error_nor_a_motion() -> None:
    plan = plan_of(columns=("base_pose",), object_quantities=("pose",))
    rows, finer = two_runs(plan)
    part = [*places_of(plan, *(f"cube.pose.q{axis}" for axis in "xyzw"))]
    rows[300:, part] *= -1
    finer[700:, part] *= -1
    pair = DifferenceAccumulator(plan)
    pair.add(rows[:500], finer[:500])
    pair.add(rows[500:], finer[500:])
    found = pair.differences()
    assert np.all(found.largest == 0)
    assert np.all(found.range == 0)


def test_components_share_the_scale_of_their_vector_and_what_stays_has_a_floor() -> None:
    plan = plan_of(columns=("joint_angles",), object_quantities=("pose", "angles"))
    ranges = np.zeros(len(columns.header(plan.recorded)) - 1)
    bent, moved = places_of(plan, "finger.actuator_0_joint_01.angle_rad", "cube.pose.x_m")
    ranges[bent - 1], ranges[moved - 1] = 0.5, 0.04
    families = column_families(plan.recorded)
    names = [(one.name, one.unit) for one in families]
    found = dict(zip(names, scales(plan, families, ranges), strict=True))
    assert found["finger joint_angles", "rad"] == 0.5
    assert found["cube pose", "m"] == 0.04
    # the cube did not turn, so its orientation is held against a hundredth of the largest angle
    assert found["cube angles", "rad"] == pytest.approx(LEAST_SHARE * 0.5)
    assert found["cube pose", "1"] == pytest.approx(LEAST_SHARE * 0.5 / 2)
    still = scales(plan, families, np.zeros_like(ranges))
    assert still[0] == LEAST_ANGLE


def test_impulses_are_those_of_every_step_wherever_rows_fall() -> None:
    plan = dataclasses.replace(plan_of(), time_step=1e-3, every=7)
    steps = 350
    every = np.array(rows_of(dataclasses.replace(plan, every=1), steps))
    forces = list(force_columns(plan.recorded))
    blocks: list[np.ndarray] = []
    rows = RowsWithImpulses(plan, lambda block: blocks.append(block.copy()))
    assert sampled_plan(plan).every == 1
    for first in range(0, len(every), 64):
        rows.take(every[first : first + 64])
    rows.finish()
    found = np.concatenate(blocks)
    width = every.shape[1]
    assert found[:, :width].tolist() == rows_of(plan, steps)
    assert rows.written == len(found) == 51
    total = 1e-3 * np.cumsum(every[:, forces], axis=0)
    assert np.abs(total).max() > 1e-4
    assert found[:, width:] == pytest.approx(total[::7], abs=1e-15)


def test_a_plan_without_forces_records_what_it_records() -> None:
    plan = plan_of(columns=("joint_angles",), object_quantities=("pose",))
    assert sampled_plan(plan) == plan
    assert width_with_impulses(plan) == len(columns.header(plan.recorded))
