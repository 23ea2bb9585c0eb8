"""Velocities, spins and turns of objects against closed forms; forces on them against momentum."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.rigid_objects import BALL, CUBE, G, scene_of_objects
from tests.builders.runs import recorded_columns, stacked_columns
from tests.builders.scenes import scene_from_text

STEPS = {"implicit": 1e-3, "euler": 1e-3, "explicit": 1e-3}


def test_the_columns_of_an_object() -> None:
    record = {"columns": [], "objects": ["velocity", "angles"]}
    scene = scene_from_text(json.dumps({**scene_of_objects(CUBE), "record": record}))
    assert columns.header(make_plan(scene).recorded) == [
        "time_s",
        *(f"cube.velocity.{axis}_m_per_s" for axis in "xyz"),
        *(f"cube.spin.{axis}_rad_per_s" for axis in "xyz"),
        *(f"cube.angles.{axis}_rad" for axis in "xyz"),
    ]


@pytest.mark.parametrize("scale", [1, 20])
@pytest.mark.parametrize("step", [1e-3, 5e-3])
def test_the_velocity_of_what_falls_is_that_of_the_instant(step: float, scale: int) -> None:
    thrown = {**CUBE, "position": [0, 0, 3], "linear_velocity": [0.3, -0.2, 1]}
    data = scene_of_objects(thrown, time_step=step, world_scale=scale)
    found = recorded_columns(data, 100, columns=[], objects=["velocity"], every=3)
    t = found["time_s"]
    assert found["cube.velocity.x_m_per_s"] == pytest.approx(0.3, abs=1e-12)
    assert found["cube.velocity.y_m_per_s"] == pytest.approx(-0.2, abs=1e-12)
    # the means of two half steps: exact where the acceleration is constant
    assert found["cube.velocity.z_m_per_s"] == pytest.approx(1 - G * t, abs=1e-9)


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (0.6, 0, -0.8)])
def test_turns_are_counted_beyond_full_ones(integrator: str, axis: tuple[float, ...]) -> None:
    spin = [40 * component for component in axis]  # rad/s: a ball has no axis to wobble about
    ball = {**BALL, "position": [0, 0, 0], "angular_velocity": spin, "rpy": [0, math.pi / 2, 0]}
    data = scene_of_objects(ball, gravity=[0, 0, 0], integrator=integrator)
    found = recorded_columns(data, 1000, columns=[], objects=["velocity", "angles"], every=7)
    t = found["time_s"]
    spins = stacked_columns(found, *(f"ball.spin.{one}_rad_per_s" for one in "xyz"))
    angles = stacked_columns(found, *(f"ball.angles.{one}_rad" for one in "xyz"))
    assert spins == pytest.approx(np.tile(spin, (len(t), 1)), abs=1e-9)
    # the engine turns by sines of small angles, to some 1e-4 of them
    assert angles == pytest.approx(np.outer(t, spin), rel=1e-3, abs=1e-6)
    assert np.linalg.norm(angles[-1]) > 6 * 2 * math.pi


def test_turns_do_not_depend_on_where_rows_fall() -> None:
    tumbling = {**CUBE, "dimensions": [0.02, 0.04, 0.07], "angular_velocity": [3, 20, 9]}
    data = scene_of_objects({**tumbling, "position": [0, 0, 1]})
    columns_by_every = [
        recorded_columns(data, 210, columns=[], objects=["angles"], every=every)
        for every in (1, 7, 21)
    ]
    for name in ("cube.angles.x_rad", "cube.angles.y_rad", "cube.angles.z_rad"):
        finest, *others = (one[name] for one in columns_by_every)
        assert finest[::7].tolist() == others[0].tolist()
        assert finest[::21].tolist() == others[1].tolist()


def test_the_turns_are_the_integral_of_the_spin() -> None:
    wheel = {**CUBE, "angular_velocity": [0.5, -0.3, 25]}
    data = scene_of_objects(wheel, ground={}, time_step=5e-4)
    found = recorded_columns(data, 400, columns=[], objects=["velocity", "angles"])
    for axis in "xyz":
        spin, angle = found[f"cube.spin.{axis}_rad_per_s"], found[f"cube.angles.{axis}_rad"]
        summed = np.concatenate([[0], np.cumsum(spin[1:] + spin[:-1]) * 5e-4 / 2])
        assert angle == pytest.approx(summed, abs=0.02)
    assert abs(found["cube.angles.z_rad"][-1]) > 0.5
