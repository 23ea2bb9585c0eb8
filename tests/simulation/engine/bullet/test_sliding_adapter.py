"""Sliding in every direction: bodies and chains stop where v²/(2 μ g) says, in the direction of v.

The engine by itself stops a long box 5 % too far and 29 % aside, a chain of links 10 % and 31 %.
"""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import actuator, hinge, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text
from tests.sliding.headings import stop
from tests.truth.surfaces import course
from tests.truth.touching import G, with_cubes

BLOCK = {"shape_type": "box", "dimensions": [0.03, 0.03, 0.03], "mass": 0.03}


@pytest.mark.parametrize("body", ["slab", "plank", "disc", "capsule", "mesh"])
@pytest.mark.parametrize("heading", [0.1, 0.9, 4.0])
def test_a_body_stops_where_it_should(body: str, heading: float) -> None:
    found = stop(body, heading, 1.7 * heading)
    assert found.beyond == pytest.approx(0, abs=5e-3)
    assert found.aside == pytest.approx(0, abs=5e-3)


def test_the_error_goes_with_the_step() -> None:
    coarse, fine = (abs(stop("slab", 0.9, 0.3, step).aside) for step in (2e-3, 5e-4))
    assert fine < 0.4 * coarse


def test_a_chain_of_links_stops_where_it_should() -> None:
    heading, speed, friction, step = 0.9, 1.0, 0.35, 1e-3
    body = actuator(6, hinge(1, 0, 0, spring_stiffness=10, spring_damping=0.1), link=BLOCK)
    path = speed**2 / (2 * friction * G)
    last = round(1.2 * speed / (friction * G) / step)
    plan = make_plan(
        scene_from_text(
            json.dumps(
                {
                    "ground": {},
                    "time_step": step,
                    "manipulators": [
                        {
                            "definition": manipulator(body, world_scale=20),
                            "base": "free",
                            "position": [0, 0, 0.015],
                            "rpy": [0, math.pi / 2, 0.3],
                            "linear_velocity": [
                                speed * math.cos(heading),
                                speed * math.sin(heading),
                                0,
                            ],
                            "surface": {"friction": friction},
                        }
                    ],
                    "record": {"every": last, "columns": ["link_positions"]},
                }
            )
        )
    )
    first, end = np.array(rows_of(plan, last))
    head = columns.header(plan.recorded)
    x, y = (
        np.mean([b - a for a, b, name in zip(first, end, head, strict=True) if name.endswith(axis)])
        for axis in (".x_m", ".y_m")
    )
    assert x * math.cos(heading) + y * math.sin(heading) == pytest.approx(path, rel=5e-3)
    assert y * math.cos(heading) - x * math.sin(heading) == pytest.approx(0, abs=5e-3 * path)


def test_the_friction_that_is_reported_has_its_limit_and_points_against_the_slip() -> None:
    plank = {
        "name": "plank",
        "dimensions": [0.2, 0.04, 0.02],
        "mass": 0.5,
        "position": [0, 0, 0.01],
        "rpy": [0, 0, 0.4],
        "linear_velocity": [0.6, 0.8, 0],
    }
    scene = with_cubes(plank, record={"columns": [], "objects": ["pose", "contact_force"]})
    found = course(scene, 1e-3, 0.1)
    force = [found[f"plank.contact.{axis}_n"][50:].mean() for axis in ("fx", "fy")]
    assert force == pytest.approx(np.array([-0.6, -0.8]) * 0.5 * 0.5 * G, rel=5e-3)


def test_a_body_that_rests_is_left_alone() -> None:
    """On a slope of 20 degrees with friction for 26."""
    angle = math.radians(20)
    gravity = [G * math.sin(angle) * 0.6, G * math.sin(angle) * 0.8, -G * math.cos(angle)]
    still = {"name": "cube", "position": [0, 0, 0.02], "rpy": [0, 0, 0.3]}
    found = course(with_cubes(still, gravity=gravity), 1e-3, 0.5)
    for axis in "xy":
        settled, *_, last = found[f"cube.pose.{axis}_m"][5:]
        assert last == pytest.approx(settled, abs=1e-12)
