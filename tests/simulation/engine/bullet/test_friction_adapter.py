"""Friction that depends on the direction, in the engine: axes, bodies, what moves away."""

from __future__ import annotations

import json
import math

import pytest

from tests.builders.definitions import X, actuator, hinge, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text
from tests.truth import surfaces
from tests.truth.touching import last_row, with_cubes

pytest.importorskip("pybullet")

CUBE = {"name": "cube", "position": [0, 0, 0.02], "linear_velocity": [0.5, 0, 0]}


@pytest.mark.parametrize("degrees", [0, 20, 45, 90, 200])
def test_oblique_sliding_follows_the_anisotropic_law(degrees: int) -> None:
    errors = [surfaces.slid(math.radians(degrees), step) for step in (2e-3, 1e-3)]
    assert errors[1] < 5.5e-4
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.1)


def test_equal_factors_are_plain_friction() -> None:
    plain = last_row(with_cubes(CUBE), 5e-4, 0.4)["cube.pose.x_m"]
    cube = {**CUBE, "friction": 1.0, "anisotropic_friction": [0.5, 0.5, 0.5]}
    assert last_row(with_cubes(cube), 5e-4, 0.4)["cube.pose.x_m"] == pytest.approx(plain, rel=0.015)


@pytest.mark.moderate
@pytest.mark.parametrize(("degrees", "slides"), [(20, False), (30, True)])
def test_on_a_slope_it_stays_below_the_angle_of_friction(degrees: int, slides: bool) -> None:
    angle = math.radians(degrees)
    gravity = [9.81 * math.sin(angle), 0, -9.81 * math.cos(angle)]
    cube = {"name": "cube", "position": [0, 0, 0.02], "anisotropic_friction": [1, 0.1, 1]}
    early, late = (
        last_row(with_cubes(cube, gravity=gravity), 1e-3, time)["cube.pose.x_m"] for time in (1, 2)
    )
    assert (late > 1) is slides
    if not slides:
        # it hangs on its springs, which do not creep
        assert abs(late - early) < 1e-9
        assert abs(late) < 2e-4


def test_what_is_slid_over_is_pulled_along() -> None:
    below = {"name": "below", "position": [0, 0, 1], "dimensions": [0.2, 0.2, 0.02]}
    above = {**CUBE, "position": [0, 0, 1.03], "anisotropic_friction": [1, 0.2, 1]}
    press = {"gravity": [0, 0, 0]}
    one, two = {**above, "linear_velocity": [0.5, 0, -0.1]}, {**below, "mass": 0.03}
    early, late = (last_row(with_cubes(one, two, **press), 1e-3, time) for time in (0.5, 0.6))
    speeds = [
        (late[f"{name}.pose.x_m"] - early[f"{name}.pose.x_m"]) / 0.1 for name in ("cube", "below")
    ]
    assert speeds[1] > 0
    assert 0.01 * speeds[0] + 0.03 * speeds[1] == pytest.approx(0.01 * 0.5, rel=1e-6)


@pytest.mark.parametrize("yaw", [0.0, 0.7, math.pi / 2])
def test_a_chain_slides_by_the_axes_of_its_links(yaw: float) -> None:
    """A chain that lies on the ground is pushed along itself, and then across."""
    link = {"shape_type": "box", "dimensions": [0.02, 0.02, 0.04], "mass": 0.05}
    joint = hinge(1, 0, 0, spring_stiffness=50, spring_damping=0.1)
    for across, factor in ((0.0, 0.1), (math.pi / 2, 1.0)):
        one = {
            "definition": manipulator(actuator(3, joint, link=link), world_scale=20),
            "base": "free",
            "position": [0, 0, 0.01],
            "rpy": [0, math.pi / 2, yaw],
            "linear_velocity": [0.5 * math.cos(yaw + across), 0.5 * math.sin(yaw + across), 0],
            "surface": {"friction": 0.5, "anisotropic_friction": [1, 1, 0.1]},
        }
        scene = {"ground": {}, "manipulators": [one], "record": {"columns": ["base_pose"]}}
        row = rows_of(scene_from_text(json.dumps(scene)), 100)[-1]
        path = math.hypot(row[1], row[2])
        time = min(0.1, 0.5 / (0.5 * factor * 9.81))
        assert path == pytest.approx(0.5 * time - 0.5 * factor * 9.81 * time**2 / 2, abs=7e-4)


def test_the_same_bytes_twice() -> None:
    one = {"definition": manipulator(actuator(3, X), world_scale=20), "position": [0, 0, 0.2]}
    surface = {"anisotropic_friction": [1, 1, 0.1]}
    scene = {"ground": {}, "manipulators": [{**one, "base": "free", "surface": surface}]}
    text = json.dumps(scene)
    assert rows_of(scene_from_text(text), 400) == rows_of(scene_from_text(text), 400)


def test_it_is_among_the_forces_that_are_recorded() -> None:
    cube = {**CUBE, "anisotropic_friction": [0.5, 1, 1]}
    record = {"objects": ["pose", "velocity", "contact_force", "contact_pairs"]}
    scene = with_cubes(cube, record=record)
    before, row = (last_row(scene, 1e-3, time) for time in (0.049, 0.051))
    force = 0.01 * (row["cube.velocity.x_m_per_s"] - before["cube.velocity.x_m_per_s"]) / 2e-3
    assert force < -0.02
    assert row["cube.contact.fx_n"] == pytest.approx(force, rel=1e-3)
    assert row["cube.contact.ground.friction_x_n"] == row["cube.contact.fx_n"]
    assert row["cube.contact.ground.friction_n"] == pytest.approx(-force, rel=1e-3)
    assert row["cube.contact.normal_n"] == pytest.approx(0.01 * 9.81, rel=1e-3)
