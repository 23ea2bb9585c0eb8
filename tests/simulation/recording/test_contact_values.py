"""Forces of contact in a moving scene: Newton's laws, row by row, for pairs and links."""

from __future__ import annotations

import json

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.rigid_objects import CUBE, G, scene_of_objects
from tests.builders.runs import recorded_columns, rows_of, stacked_columns
from tests.builders.scenes import scene_from_file, scene_from_text

FORCE = ("fx_n", "fy_n", "fz_n")
LOAD = (*FORCE, "normal_n", "friction_n", "friction_x_n", "friction_y_n", "friction_z_n")


def test_the_names_of_pairs_and_links() -> None:
    one = {"name": "a", "definition": manipulator(actuator(1, X)), "position": [0, 0, 1]}
    data = {
        "manipulators": [one, {**one, "name": "b"}],
        "objects": [CUBE],
        "ground": {},
        "record": {
            "columns": ["link_contact_forces", "contact_pairs"],
            "objects": ["contact_pairs"],
        },
    }
    names = columns.header(make_plan(scene_from_text(json.dumps(data))).recorded)
    assert names == [
        "time_s",
        *(
            f"{body}.{middle}.{one}"
            for body, other in ("ab", "ba")
            for middle in (
                "base.contact",
                "actuator_0_segment_01.contact",
                f"contact.{other}",
                "contact.cube",
                "contact.ground",
            )
            for one in LOAD
        ),
        *(f"cube.contact.{other}.{one}" for other in ("a", "b", "ground") for one in LOAD),
    ]


def test_sliding_friction_is_against_the_velocity_and_changes_the_momentum() -> None:
    # whatever was loaded first: the upper cube slides on the lower one, which slides on the ground
    lower = {**CUBE, "name": "lower", "mass": 0.03}
    upper = {**CUBE, "position": [0, 0, 0.06], "linear_velocity": [0.4, 0.1, 0]}
    for order in ((lower, upper), (upper, lower)):
        # backward Euler: one step's change of velocity is one step's force
        data = scene_of_objects(*order, ground={"friction": 0.1}, integrator="euler")
        found = recorded_columns(
            data, 60, columns=[], objects=["velocity", "contact_force", "contact_pairs"]
        )
        for name, mass in (("lower", 0.03), ("cube", 0.01)):
            speed = stacked_columns(found, *(f"{name}.velocity.{axis}_m_per_s" for axis in "xyz"))
            force = stacked_columns(found, *(f"{name}.contact.{one}" for one in FORCE))
            gained = mass * np.diff(speed, axis=0) / 1e-3
            assert gained == pytest.approx(force[1:] - np.array([0, 0, mass * G]), abs=1e-9)
        rubbed = stacked_columns(
            found, "cube.contact.lower.friction_x_n", "lower.contact.cube.friction_x_n"
        )
        assert rubbed[5, 0] < -0.02
        assert rubbed[:, 0] == pytest.approx(-rubbed[:, 1], abs=1e-9)


def test_the_forces_of_a_grasp_add_up() -> None:
    pytest.importorskip("pybullet")
    record = {
        "every": 5,
        "columns": ["contact_force", "contact_pairs", "link_contact_forces"],
        "objects": ["contact_force", "contact_pairs"],
    }
    scene = scene_from_file("push_scene.yaml", f"record={json.dumps(record)}")
    names = columns.header(make_plan(scene).recorded)
    found = dict(zip(names, np.array(rows_of(scene, 1500)).T, strict=True))
    links = [link.name for link in scene.manipulators[0].compiled.chain.links]
    for one in (*FORCE, "normal_n"):
        on_finger = found[f"finger.contact.{one}"]
        by_pair = sum(found[f"finger.contact.{other}.{one}"] for other in ("cube", "ground"))
        by_link = sum(found[f"finger.{link}.contact.{one}"] for link in links)
        assert by_pair == pytest.approx(on_finger, abs=1e-9)
        assert by_link == pytest.approx(on_finger, abs=1e-9)
        on_cube = sum(found[f"cube.contact.{other}.{one}"] for other in ("finger", "ground"))
        assert on_cube == pytest.approx(found[f"cube.contact.{one}"], abs=1e-9)
    for one in LOAD:
        sign = 1 if one in ("normal_n", "friction_n") else -1
        there, back = found[f"finger.contact.cube.{one}"], found[f"cube.contact.finger.{one}"]
        assert there == pytest.approx(sign * back, abs=1e-9)
    assert found["cube.contact.finger.fy_n"].max() > 0.01  # it pushes towards +y
    assert found["cube.contact.ground.friction_y_n"].min() < -0.01  # and the ground against it
    # within the pyramid of friction: 0.5 times 0.5 along each of two directions
    ground = found["cube.contact.ground.friction_n"]
    assert (ground <= np.sqrt(2) * 0.25 * found["cube.contact.ground.normal_n"] + 1e-9).all()


def test_there_is_one_call_of_the_engine_for_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pybullet")
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    asked: list[int] = []
    touches = BulletWorld.contact_points

    def counted(world: BulletWorld) -> object:
        asked.append(1)
        return touches(world)

    monkeypatch.setattr(BulletWorld, "contact_points", counted)
    rows = rows_of(scene_from_file("push_scene.yaml"), 100)
    assert len(asked) == len(rows) - 1 == 10  # nothing has touched at the start
