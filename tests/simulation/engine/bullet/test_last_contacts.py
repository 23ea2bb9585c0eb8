"""Contact points have the engine's numbers under the right names, of the last step."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest

from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.last_contacts import (
    EngineContact,
    LastContacts,
    contacts_of_body,
)
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.builders.scenes import scene_from_text

RADIUS, MASS, STEP, FRICTION = 0.1, 2.0, 1e-3, 0.5


@pytest.fixture
def engine() -> Iterator[BulletClient]:
    """A ball, body 1, that rests on a slab, body 0, and is pushed along +x to slide."""
    client = BulletClient()
    client.setPhysicsEngineParameter(fixedTimeStep=STEP)
    client.setGravity(0, 0, -10)
    slab = client.createCollisionShape(client.GEOM_BOX, halfExtents=[1, 1, 0.1])
    ball = client.createCollisionShape(client.GEOM_SPHERE, radius=RADIUS)
    client.createMultiBody(0, slab, -1, [0, 0, -0.1])
    client.createMultiBody(MASS, ball, -1, [0, 0, RADIUS])
    for body in (0, 1):
        client.changeDynamics(body, -1, lateralFriction=FRICTION**0.5)
    client.resetBaseVelocity(1, [1, 0, 0], [0, 0, 0])
    for _ in range(3):
        client.stepSimulation()
    yield client
    client.close()


def friction(contact: EngineContact) -> np.ndarray:
    along = np.array([contact.tangent_1, contact.tangent_2])
    return np.array([contact.friction_1, contact.friction_2]) @ along


def test_the_names_are_those_of_the_engine_s_numbers(engine: BulletClient) -> None:
    (contact,) = LastContacts(engine).points()
    assert sorted((contact.key[:2], contact.key[2:])) == [(0, -1), (1, -1)]
    sign = 1.0 if contact.first_body == 1 else -1.0
    assert np.allclose(sign * np.array(contact.normal), [0, 0, 1], atol=1e-6)
    assert contact.normal_force == pytest.approx(10 * MASS, rel=1e-3)
    assert np.allclose(sign * friction(contact), [-FRICTION * 10 * MASS, 0, 0], rtol=1e-3)
    between = np.subtract(contact.on_first, contact.on_second) @ np.array(contact.normal)
    assert contact.gap == pytest.approx(between, abs=1e-9)


def test_a_body_that_is_asked_for_comes_first(engine: BulletClient) -> None:
    for body, sign in ((0, -1.0), (1, 1.0)):
        (contact,) = contacts_of_body(engine, body)
        assert contact.first_body == body
        assert np.allclose(contact.normal, [0, 0, sign], atol=1e-6)


def test_readers_of_a_step_share_one_list_and_the_next_step_has_its_own() -> None:
    ball = {
        "name": "ball",
        "shape_type": "sphere",
        "dimensions": [0.02],
        "mass": 0.05,
        "position": [0.3, 0, 0.02],
    }
    finger = {"definition": "finger.yaml", "position": [0, 0, 0.5]}
    scene = {"manipulators": [finger], "ground": {}, "objects": [ball]}
    with BulletWorld(make_plan(scene_from_text(json.dumps(scene)))) as world:
        for _ in range(5):
            world.step()
        points = world.contacts.points()
        assert points
        assert world.contacts.points() is points
        world.step()
        assert world.contacts.points() is not points
