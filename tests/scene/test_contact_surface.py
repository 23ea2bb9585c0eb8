"""Surfaces as they are read, and scaled."""

from __future__ import annotations

import json

import pytest

from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.scene import contact_surface
from somo_cli.scene.contact_surface import ContactCompliance, ContactSurface, Ground
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import X, actuator, chain_of, manipulator
from tests.builders.scenes import scene_from_text

EVERYTHING = {
    "friction": 0.4,
    "spinning_friction": 1e-3,
    "rolling_friction": 2e-3,
    "restitution": 0.3,
    "contact_stiffness": 500,
    "contact_damping": 2,
    "anisotropic_friction": [1, 0.5, 0.1],
}
WHOLE = ContactSurface(0.4, 1e-3, 2e-3, 0.3, ContactCompliance(500.0, 2.0), (1.0, 0.5, 0.1))


def test_a_surface_is_read_with_all_it_says() -> None:
    assert contact_surface.read_surface(EVERYTHING) == WHOLE
    assert contact_surface.read_surface({}) == ContactSurface(0.5)
    assert contact_surface.read_ground({}) == Ground(0.0, ContactSurface(1.0, restitution=1.0))
    assert contact_surface.read_ground({"height": 2, "restitution": 0.5}) == Ground(
        2.0, ContactSurface(1.0, restitution=0.5)
    )


def test_parts_of_a_manipulator_change_what_they_name() -> None:
    found = contact_surface.read_surfaces(
        {**EVERYTHING, "base": {"friction": 2}, "tips": {"restitution": 0}}
    )
    chain = chain_of(manipulator(actuator(3, X)))
    ends = [found.of_link(link, chain) for link in range(4)]
    assert ends[1] == ends[2] == WHOLE
    assert (ends[0].friction, ends[0].restitution) == (2.0, 0.3)
    assert (ends[3].friction, ends[3].restitution) == (0.4, 0.0)


def test_a_moment_arm_is_a_length_and_a_contact_stiffness_is_no_joint_stiffness() -> None:
    assert scaled(WHOLE, Scale(20, 3)) == ContactSurface(
        0.4, 20e-3, 40e-3, 0.3, ContactCompliance(1500.0, 6.0), (1.0, 0.5, 0.1)
    )


@pytest.mark.parametrize(
    ("of_scene", "of_one", "can_touch"),
    [
        ({}, {}, False),
        ({}, {"surface": EVERYTHING}, False),
        ({}, {"self_collision": False}, False),
        ({}, {"self_collision": True}, True),
        ({"ground": {"height": 0}}, {}, True),
        ({"ground": {"height": -9}}, {}, False),
    ],
)
def test_shapes_are_loaded_where_something_can_touch(
    of_scene: dict[str, object], of_one: dict[str, object], can_touch: bool
) -> None:
    one = {"definition": manipulator(actuator(2, X)), **of_one}
    plan = make_plan(scene_from_text(json.dumps({"manipulators": [one], **of_scene})))
    assert plan.can_touch is can_touch
    assert ("<collision>" in plan.bodies[0].urdf) is can_touch
