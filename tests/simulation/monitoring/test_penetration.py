from __future__ import annotations

import json

import pytest

from somo_cli.simulation import run as stepping
from somo_cli.simulation.monitoring.penetration import (
    Penetration,
    PenetrationMonitor,
    steps_between_samples,
)
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.fake_world import FakeWorld, plan_of_hinges
from tests.builders.rigid_objects import plan_with_plate
from tests.builders.runs import simulated
from tests.builders.scenes import scene_from_text


def test_the_deepest_relative_to_the_thinner_one_is_kept() -> None:
    plan = plan_with_plate()
    world = FakeWorld(plan)
    monitor = PenetrationMonitor(plan, world)
    monitor.update(0)
    assert monitor.deepest is None
    world.depths = [((0, 1), (2, 0), 0.02), ((0, 1), (1, 0), 0.012)]
    monitor.update(8)
    world.depths = [((0, 1), (2, 0), 0.03)]
    monitor.update(16)
    # 0.012 engine units are 0.6 mm, of the plate's 4; 1.5 mm of the link's 17 are less
    assert monitor.deepest == Penetration(
        0.008, pytest.approx(6e-4), pytest.approx(0.15), ("body", "plate")
    )
    assert not monitor.deepest.is_deep
    assert Penetration(0.0, 1e-3, 0.25, ("a", "b")).is_deep


def test_a_deep_penetration_is_a_finding() -> None:
    plan = plan_with_plate(6e-3)
    world = FakeWorld(plan)
    monitor = PenetrationMonitor(plan, world)
    world.depths = [((0, 1), (1, 0), 0.012)]
    monitor.update(2)
    assert monitor.finding() is None  # 15 % of the plate's thickness
    world.depths = [((0, 1), (1, 0), 0.019)]
    monitor.update(4)
    found = monitor.finding()
    assert found is not None
    assert (found.code, found.names, found.time) == ("deep-penetration", ("body", "plate"), 0.024)
    assert found.message == (
        "at 0.024 s 'body' and 'plate' were 0.95 mm deep in each other, 24 % of the thinner one's "
        "thickness: contact was not followed"
    )
    assert found.hint == (
        "try half the step, --time-step 0.003, and see that they do not overlap at the start"
    )
    assert dict(found.values) == {
        "depth_m": pytest.approx(9.5e-4),
        "depth_ratio": pytest.approx(0.2375),
    }


@pytest.mark.parametrize(
    ("step", "count"), [(1e-4, 8), (1e-3, 8), (2e-3, 4), (5e-3, 1), (1e-2, 1), (1, 1)]
)
def test_penetration_is_sampled_at_least_every_8_ms(step: float, count: int) -> None:
    assert steps_between_samples(step, 8) == count


def test_a_scene_in_which_nothing_can_touch_is_not_asked() -> None:
    plan = plan_of_hinges()
    world = FakeWorld(plan)
    world.depths = [((0, 0), (0, 1), 1.0)]
    summary = stepping.run(plan, world, lambda values: None, 20, lambda: 0.0)
    assert summary.deepest is None


def test_an_overlap_at_the_start_is_seen_in_the_engine() -> None:
    pytest.importorskip("pybullet")
    one = {"definition": manipulator(actuator(1, X), world_scale=20), "position": [0, 0, 9]}
    size = {"shape_type": "box", "dimensions": [0.04, 0.04, 0.04], "mass": 0.01}
    cubes = [{**size, "name": f"cube_{n}", "position": [0, 0, 0.03 * n]} for n in range(2)]
    data = {"gravity": [0, 0, 0], "manipulators": [one], "objects": cubes}
    _, summary = simulated(scene_from_text(json.dumps(data)), 8)
    assert summary.deepest is not None
    assert summary.deepest.bodies == ("cube_0", "cube_1")
    assert summary.deepest.depth == pytest.approx(0.01, rel=1e-3)
    assert summary.deepest.depth_ratio == pytest.approx(0.25, rel=1e-3)
    assert summary.deepest.is_deep
