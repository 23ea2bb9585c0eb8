"""What prescribed motion can have put in: no false alarm, and no diverged run that goes unseen."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.integrator.motion_work_bound import MotionWorkBound
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import Data
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text


def plan_on_moved_base(motion: Data, *objects: Data, **of_scene: Any) -> Plan:
    """Return a plan of the shipped finger, upright on a moved base."""
    one = {"definition": "finger.yaml", "base": "constrained", "motion": motion}
    data = {"manipulators": [{**one, "position": [0, 0, 0.3]}], "objects": list(objects)}
    return make_plan(scene_from_text(json.dumps({**data, **of_scene})))


def shaken(frequency: float, amplitude: float) -> Data:
    times = [n / (8 * frequency) for n in range(round(8 * frequency))]
    paths = [amplitude * (1 - math.cos(2 * math.pi * frequency * time)) for time in times]
    return {"translation": [[time, path, 0, 0] for time, path in zip(times, paths, strict=True)]}


MOTIONS: dict[str, Data] = {
    "shaken": shaken(20, 0.01),
    "at its own frequency": shaken(1.8, 0.02),
    "spun": {"rotation": [[0, 0, 0, 0], [1, 12, 0, 0]]},
    "spun about a point": {"rotation": [[0, 0, 0, 0], [1, 0, 12, 0]], "about": [0, 0.1, 0.5]},
    "jerked": {
        "translation": [[0.1 * n, 0, 0.05 * (n % 2), 0] for n in range(10)],
        "interpolation": "linear",
    },
}


@pytest.mark.moderate
@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_a_lively_motion_is_no_divergence(name: str, step: float) -> None:
    pytest.importorskip("pybullet")
    rows_of(plan_on_moved_base(MOTIONS[name], time_step=step), round(1 / step))


@pytest.mark.parametrize("strokes", [1, 10])
def test_nor_is_a_finger_that_is_pushed_or_hammered(strokes: int) -> None:
    pytest.importorskip("pybullet")
    path = [[n / strokes, 0, -0.1 * (n % 2), 0] for n in range(strokes + 1)]
    plate = {
        "name": "plate",
        "shape_type": "box",
        "dimensions": [0.1, 0.02, 0.1],
        "position": [0, 0.1, 0.4],
        "motion": {"translation": path},
    }
    rows_of(plan_on_moved_base({"translation": [[0, 0, 0, 0]]}, plate, time_step=2e-3), 500)


@pytest.mark.parametrize("name", MOTIONS)
def test_a_diverged_run_is_seen_all_the_same(name: str) -> None:
    pytest.importorskip("pybullet")
    plan = plan_on_moved_base(
        MOTIONS[name], integrator="explicit"
    )  # which needs steps below 0.37 ms
    with pytest.raises(SimulationDiverged) as caught:
        rows_of(plan, 1000)
    assert caught.value.step < 300


def velocity(*values: float) -> np.ndarray:
    return np.array(values, float)


def test_in_the_frame_acceleration_pulls_and_a_turn_lets_fall() -> None:
    plan = plan_on_moved_base({"translation": [[0, 0, 0, 0]]})
    (body,) = plan.bodies
    mass = sum(link.inertial.mass for link in body.chain.links[1:])
    one = MotionWorkBound(plan, body.chain)
    one.advance(velocity(0, 0, 0, 0, 0, 0), velocity(0, 0, 0, 3, 4, 0))
    # what hangs loose and at rest gets no more than m v² / 2
    assert one.frame_work(0.0) == pytest.approx(mass * 25 / 2)
    assert one.frame_work(0.0) == 0
    one.advance(velocity(0, 0, 0, 3, 4, 0), velocity(0, 0, 0, 3, 4, 0))
    assert one.frame_work(7.0) == 0
    slow = 1e-6  # rad/s, all along
    one.advance(velocity(slow, 0, 0, 0, 0, 0), velocity(slow, 0, 0, 0, 0, 0))
    fallen = one.frame_work(0.0)
    weight = mass * 9.81 * 20 * slow * plan.time_step
    assert body.chain.length * weight < fallen < 1.5 * body.chain.length * weight


def test_pushing_does_force_times_displacement_and_each_impact_more() -> None:
    plan = plan_on_moved_base({"translation": [[0, 0, 0, 0]]}, ground={"height": -9})
    one = MotionWorkBound(plan, plan.bodies[0].chain)
    mass = sum(link.inertial.mass for link in plan.bodies[0].chain.links)
    one.advance(velocity(0, 0, 0, 2, 0, 0), velocity(0, 0, 0, 2, 0, 0))
    assert one.contact_work((0, 0, 0, 0)) == 0
    for _ in range(2):
        one.advance(velocity(0, 0, 0, 2, 0, 0), velocity(0, 0, 0, 2, 0, 0))
        path = 2 * plan.time_step
        assert one.contact_work((3, 0, 4, 4)) == pytest.approx(9 * path + 2 * mass * 4)
        one.advance(velocity(0, 0, 0, 2, 0, 0), velocity(0, 0, 0, 2, 0, 0))
        assert one.contact_work((3, 0, 4, 4)) == pytest.approx(9 * path)
        assert one.contact_work((0, 0, 0, 0)) == 0
    assert not plan_on_moved_base({"translation": [[0, 0, 0, 0]]}).can_touch
