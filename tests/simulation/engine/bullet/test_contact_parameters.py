"""Parameters of surfaces in the engine, and the motion that follows."""

from __future__ import annotations

import json
import math

import pytest

from somo_cli.scene.contact_surface import ContactCompliance, ContactSurface
from somo_cli.simulation.engine.bullet.contact_parameters import (
    contact_parameters,
    surface_settings,
)
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text
from tests.truth import surfaces
from tests.truth.touching import last_row, with_cubes

pytest.importorskip("pybullet")

BALL = {**surfaces.BALL, "name": "ball"}


def test_the_engine_gets_only_the_properties_that_a_surface_has() -> None:
    assert surface_settings(ContactSurface(0.5)) == {"lateralFriction": 0.5}
    assert surface_settings(ContactSurface(0.0, 1e-3, 2e-3, 0.5, ContactCompliance(7.0, 0.0))) == {
        "lateralFriction": 0.0,
        "spinningFriction": 1e-3,
        "rollingFriction": 2e-3,
        "restitution": 0.5,
        "contactStiffness": 7.0,
        "contactDamping": 0.0,
    }


def test_directed_friction_is_not_the_engines() -> None:
    assert surface_settings(ContactSurface(0.5, friction_anisotropy=(1.0, 1.0, 0.1))) == {
        "lateralFriction": 0.0
    }


def test_only_what_rebounds_changes_the_engine() -> None:
    assert set(contact_parameters(make_plan(with_cubes(BALL)))) == {"contactBreakingThreshold"}
    hopping = make_plan(with_cubes({**BALL, "restitution": 0.5}))
    assert set(contact_parameters(hopping)) == {
        "contactBreakingThreshold",
        "contactERP",
        "restitutionVelocityThreshold",
    }


def test_a_scene_that_rebounds_leaves_nothing_behind() -> None:
    rolling = with_cubes({**BALL, "rolling_friction": 1e-3, "linear_velocity": [0.3, 0, 0]})
    before = last_row(rolling, 2e-3, 0.2)
    last_row(with_cubes({**BALL, "restitution": 0.5}), 2e-3, 0.01)
    assert last_row(rolling, 2e-3, 0.2) == before


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.9])
@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_a_ball_rebounds(restitution: float, step: float) -> None:
    found = surfaces.rebound(restitution, step, 0.1)
    assert found == pytest.approx(restitution, abs=0.035)


def test_balls_that_collide_keep_their_momentum() -> None:
    apart, change = surfaces.head_on(0.5, 1e-3)
    assert apart == pytest.approx(0.5, abs=2e-3)
    assert change == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("restitution", [0, 0.5, 0.9])
@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_a_tumbling_cube_gains_no_energy(restitution: float, step: float) -> None:
    assert surfaces.most_energy(step, restitution) <= 1 + 1e-9


def test_what_rebounds_still_stacks() -> None:
    stack = [
        {"name": f"cube_{n}", "position": [0, 0, 0.02 + 0.04 * n], "restitution": 0.5}
        for n in range(3)
    ]
    end = last_row(with_cubes(*stack), 2e-3, 1.0)
    weights = [end[f"cube_{n}.contact.normal_n"] / (0.01 * surfaces.G) for n in range(3)]
    assert weights == pytest.approx([5, 3, 1], rel=1e-3)
    assert end["cube_2.pose.z_m"] == pytest.approx(0.1, abs=2e-5)


def test_spinning_friction_stops_a_spin() -> None:
    found, expected = surfaces.spun(1e-3)
    assert found == pytest.approx(expected, rel=2e-3)


def test_rolling_friction_stops_a_ball() -> None:
    found, expected = surfaces.rolled(1e-3)
    assert found == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("stiffness", [100, 1000])
def test_a_soft_contact_is_as_stiff_as_asked_for(stiffness: float) -> None:
    assert surfaces.sunk(1e-3, stiffness) == pytest.approx(1, abs=6e-3)


def test_two_soft_surfaces_are_springs_in_series() -> None:
    soft = {"contact_stiffness": 100, "contact_damping": 1}
    end = last_row(with_cubes({**BALL, **soft}, ground=soft), 1e-3, 1.0)
    depth = surfaces.RADIUS - end["ball.pose.z_m"]
    assert depth == pytest.approx(surfaces.MASS * surfaces.G / 50, rel=1e-3)


def test_a_fast_object_is_not_held_back() -> None:
    fast = {**BALL, "position": [0, 0, 50], "linear_velocity": [30, 0, 0]}
    end = last_row(with_cubes(fast, gravity=[0, 0, 0]), 1e-3, 0.1)
    assert end["ball.pose.x_m"] == pytest.approx(3, rel=1e-9)


@pytest.mark.parametrize(
    ("surface", "hops"),
    [
        ({"restitution": 0.8}, True),
        ({"links": {"restitution": 0.8}}, True),
        ({"base": {"restitution": 0.8}, "tips": {"restitution": 0.8}}, False),
        ({"restitution": 0.8, "links": {"restitution": 0}}, False),
    ],
)
def test_a_part_of_a_manipulator_has_its_own_surface(
    surface: dict[str, object], hops: bool
) -> None:
    """Three balls in a row fall flat, and the large one in the middle touches the ground."""
    end = fallen(surface)
    # 0.05 m deep; the height of the base 40 ms after the impact at 0.1 s
    rising = 0.8 * math.sqrt(2 * surfaces.G * 0.05) * 0.04 - surfaces.G * 0.04**2 / 2
    assert end == pytest.approx(rising if hops else 0.0, abs=2e-3)


def fallen(surface: dict[str, object]) -> float:
    """Return how high above its rest the body is after 0.14 s."""
    link = {"shape_type": "sphere", "dimensions": [0.02], "mass": 0.05}
    one = {
        "definition": manipulator(actuator(2, X, link=link), world_scale=20),
        "base": "free",
        "position": [0, 0, 0.07],
        "rpy": [0, math.pi / 2, 0],
        "surface": surface,
    }
    record = {"columns": ["base_pose"], "every": 141}
    scene = {"ground": {}, "manipulators": [one], "record": record}
    return rows_of(scene_from_text(json.dumps(scene), "record.every=141"), 141)[-1][3] - 0.02


def test_every_link_has_the_friction_asked_for() -> None:
    one = {
        "definition": manipulator(actuator(2, X)),
        "surface": {"friction": 2, "restitution": 0.1},
    }
    plan = make_plan(scene_from_text(json.dumps({"manipulators": [one], "ground": {"height": -1}})))
    bullet = pytest.importorskip("pybullet")
    with BulletWorld(plan) as world:
        body, client = world.bodies[0], world.engine.number
        reported = [bullet.getDynamicsInfo(body.index, link, client) for link in body.links]
    assert [(one[1], one[5]) for one in reported] == [(2.0, 0.1)] * 3
