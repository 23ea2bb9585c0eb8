"""Scenes read from documents: what is said, what is assumed, and what is no scene at all."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import pytest

from somo_cli.document.parse import parse
from somo_cli.manipulator.dimensions import Scale
from somo_cli.scene import model as scene_model
from somo_cli.scene import reader as scene_reader
from somo_cli.scene.actuation import Actuation, WaveProfile, WaypointProfile
from somo_cli.scene.contact_surface import (
    DEFAULT_SURFACE,
    ContactSurface,
    Ground,
    ManipulatorSurfaces,
)
from somo_cli.scene.model import ExternalLoad, Scene
from somo_cli.scene.signals import Wave
from tests.builders.definitions import X, Y, actuator, manipulator
from tests.builders.scenes import DEFINITIONS, scene_from_text

BODY = manipulator(actuator(2, X, Y))
ONE = {"definition": BODY}
BALL = {
    "name": "ball",
    "shape_type": "sphere",
    "dimensions": [0.1],
    "mass": 1,
    "position": [9, 0, 0],
}


def read(data: dict[str, Any]) -> Scene:
    return scene_from_text(json.dumps(data))


def with_one(**of_manipulator: Any) -> Scene:
    return read({"manipulators": [{"definition": BODY, **of_manipulator}]})


def test_what_is_assumed() -> None:
    found = with_one()
    of_scene = {field.name: getattr(found, field.name) for field in dataclasses.fields(found)}
    of_scene.pop("manipulators")
    assert of_scene == {
        "time_step": 1e-3,
        "gravity": (0.0, 0.0, -9.81),
        "integrator": "implicit",
        "scale": Scale(1.0, 1.0),
        "every": 1,
        "reference": None,
        "ground": None,
        "objects": (),
        "object_quantities": ("pose",),
        "only": (),
        "stop_conditions": (),
        "has_contact_events": False,
        "is_time_step_automatic": False,
        "duration": None,
        "expected_tip_error": None,
        "columns": ("joint_angles", "tip_position"),
    }
    (one,) = found.manipulators
    of_one = {field.name: getattr(one, field.name) for field in dataclasses.fields(one)}
    assert of_one.pop("compiled").definition.name == "body"
    assert of_one == {
        "name": "body",
        "position": (0.0, 0.0, 0.0),
        "rpy": (0.0, 0.0, 0.0),
        "base": "static",
        "initial_angles": (0.0, 0.0),
        "initial_rates": (0.0, 0.0),
        "linear_velocity": (0.0, 0.0, 0.0),
        "angular_velocity": (0.0, 0.0, 0.0),
        "actuation": (),
        "loads": (),
        "surfaces": ManipulatorSurfaces(DEFAULT_SURFACE, DEFAULT_SURFACE, DEFAULT_SURFACE),
        "has_self_collision": False,
        "motion": None,
    }


def test_every_key_of_a_scene_is_read() -> None:
    found = read(
        {
            "time_step": 1,
            "gravity": [1, 2, 3],
            "world_scale": {"length": 20, "mass": 10},
            "integrator": "euler",
            "record": {"every": 7, "columns": ["curvatures", "base_pose", "curvatures"]},
            "manipulators": [
                {
                    "name": "left",
                    "definition": BODY,
                    "position": [4, 5, 6],
                    "rpy": [0.1, 0.2, 0.3],
                    "base": "free",
                    "initial_angles": [1, 2],
                    "initial_rates": 3,
                    "linear_velocity": [7, 8, 9],
                    "angular_velocity": [-7, -8, -9],
                    "actuation": [
                        {"actuator": 0, "axis": 1, "torque": 2},
                        {
                            "actuator": 0,
                            "axis": 0,
                            "waypoints": [[0, 1], [2, 1]],
                            "interpolation": "cubic",
                            "repeat": True,
                        },
                    ],
                }
            ],
        }
    )
    assert (found.time_step, found.gravity, found.integrator) == (1.0, (1.0, 2.0, 3.0), "euler")
    assert (found.scale, found.every) == (Scale(20.0, 10.0), 7)
    assert found.columns == ("curvatures", "base_pose")
    (one,) = found.manipulators
    assert (one.name, one.base, one.position, one.rpy) == (
        "left", "free", (4.0, 5.0, 6.0), (0.1, 0.2, 0.3),
    )  # fmt: skip
    assert (one.initial_angles, one.initial_rates) == ((1.0, 2.0), (3.0, 3.0))
    assert one.linear_velocity == (7.0, 8.0, 9.0)
    assert one.angular_velocity == (-7.0, -8.0, -9.0)
    assert one.actuation == (
        Actuation(0, 1, WaypointProfile(((0.0, 2.0),))),
        Actuation(0, 0, WaypointProfile(((0.0, 1.0), (2.0, 1.0)), "cubic", True)),
    )


def test_a_ground_and_how_it_is_touched() -> None:
    plain = read({"ground": {}, "manipulators": [{"definition": BODY}]})
    assert plain.ground == Ground(0.0, ContactSurface(1.0, restitution=1.0))
    one = {"definition": BODY, "surface": {"friction": 2}}
    other = read({"ground": {"height": -1, "friction": 0}, "manipulators": [one]})
    assert other.ground == Ground(-1.0, ContactSurface(0.0, restitution=1.0))
    assert other.manipulators[0].surfaces.all == (ContactSurface(2.0),) * 3


def test_loads_are_on_links_of_the_chain() -> None:
    one = with_one(
        loads=[
            {"force": [1, 2, 3], "point": [0, 0, 4]},
            {
                "link": "actuator_0_segment_01",
                "point": [4, 5, 6],
                "force": [1, 1, 1],
                "moment": [7, 8, 9],
                "frame": "body",
                "waypoints": [[0, 1], [2, 3]],
                "interpolation": "step",
                "repeat": True,
            },
            {"link": "base", "force": [1, 0, 0]},
        ]
    ).manipulators[0]
    x, y, z = one.compiled.chain.tip
    nothing = (0.0, 0.0, 0.0)
    assert one.loads == (
        ExternalLoad(2, (x, y, z + 4), (1, 2, 3), nothing, "world", ((0.0, 1.0),), "linear", False),
        ExternalLoad(1, (4, 5, 6), (1, 1, 1), (7, 8, 9), "body", ((0, 1), (2, 3)), "step", True),
        ExternalLoad(0, nothing, (1, 0, 0), nothing, "world", ((0, 1),), "linear", False),
    )
    with pytest.raises(ValueError, match="elbow"):
        scene_reader.link_index("elbow", one.compiled.chain)


def test_a_pressure_becomes_the_torque_that_the_joints_make_of_it() -> None:
    body = manipulator(actuator(2, X | {"torque_per_pressure": -5e-7}, Y))
    points = [[0, 0], [1, 2e5]]
    data = [
        {"actuator": 0, "axis": 0, "pressure": 1e5},
        {"actuator": 0, "axis": 0, "waypoints": points, "input": "pressure"},
        {"actuator": 0, "axis": 1, "waypoints": points, "input": "torque"},
    ]
    found = []
    for entry in data:
        profile = with_one(definition=body, actuation=[entry]).manipulators[0].actuation[0].profile
        assert isinstance(profile, WaypointProfile)
        found.append(profile.points)
    factor = -5e-7
    assert found == [
        ((0.0, factor * 1e5),),
        ((0.0, 0.0), (1.0, factor * 2e5)),
        ((0.0, 0.0), (1.0, 2e5)),
    ]


def test_a_wave_travels_along_several_actuators() -> None:
    body = manipulator(*(actuator(2, X, Y) for _ in range(3)))
    wave = {"amplitude": 2, "frequency": 0.5, "phase": 1, "lag": 0.25, "offset": 3}
    entry = {"actuators": "all", "axis": 1, "wave": wave}
    found = with_one(definition=body, actuation=[entry]).manipulators[0].actuation
    assert found == tuple(
        Actuation(number, 1, WaveProfile(Wave("sine", 2.0, 0.5, 1 - 0.25 * number, 3.0)))
        for number in range(3)
    )
    back = entry | {"actuators": [2, 0]}
    found = with_one(definition=body, actuation=[back]).manipulators[0].actuation
    assert [one.actuator for one in found] == [2, 0]


def test_channels_are_mixed_by_a_matrix() -> None:
    gait = {
        "settings": {"traj_type": "direct"},
        "config": {"setpoints": {"main": [[0, 1, 2], [1, 3, 5]], "suffix": [[2, 0, 0]]}},
    }
    body = manipulator(actuator(2, X | {"torque_per_pressure": 0.5}, Y))
    data = {
        "trajectories": [{"name": "gait", "sorotraj": gait, "repetitions": 2, "invert": [1]}],
        "manipulators": [
            {
                "definition": body,
                "actuation": [
                    {"actuator": 0, "axis": 0, "trajectory": "gait", "mix": [1, 1],
                     "input": "pressure"},
                    {"actuator": 0, "axis": 1, "trajectory": "gait", "mix": [2, -10]},
                ],
            }
        ],
    }  # fmt: skip
    first, second = read(data).manipulators[0].actuation
    assert first.profile == WaypointProfile(((0.0, -0.5), (1.0, -1.0), (2.0, -1.0), (4.0, 0.0)))
    assert second.profile == WaypointProfile(((0.0, 22.0), (1.0, 56.0), (2.0, 56.0), (4.0, 0.0)))


def test_whole_numbers_become_floats() -> None:
    one = with_one(position=[1, 2, 3], initial_angles=1).manipulators[0]
    assert all(type(value) is float for value in (*one.position, *one.initial_angles))


def test_one_number_is_for_every_joint_and_a_list_for_each() -> None:
    assert scene_reader.values_per_joint(0.5, 3) == (0.5, 0.5, 0.5)
    assert scene_reader.values_per_joint([1, 2, 3], 3) == (1.0, 2.0, 3.0)


def test_a_file_in_place_of_a_mapping() -> None:
    found = scene_from_text("manipulators: [{definition: finger.yaml}]")
    assert found.manipulators[0].name == "finger"
    assert len(found.manipulators[0].compiled.chain.joints) == 10


def test_the_world_scale_is_that_of_the_definitions_unless_the_scene_has_one() -> None:
    twenty = {**BODY, "world_scale": 20}
    assert read({"manipulators": [{"definition": BODY}]}).scale == Scale()
    assert read({"manipulators": [{"definition": twenty}]}).scale == Scale(20.0)
    own = {"world_scale": 3, "manipulators": [{"definition": twenty}]}
    assert read(own).scale == Scale(3.0)
    two = [{"definition": twenty, "name": name} for name in ("a", "b")]
    assert read({"manipulators": two}).scale == Scale(20.0)
    different = [{"definition": twenty}, {"definition": BODY, "name": "b"}]
    assert read({"world_scale": 3, "manipulators": different}).scale == Scale(3.0)


@pytest.mark.parametrize(
    ("text", "is_scene"),
    [
        ("manipulators: []", True),
        ("{manipulators: 3, manipulator_name: a}", True),
        ("{gravity: [0, 0, 0]}", True),
        ("{integrator: euler, n_act: 1}", True),
        ("{manipulator_name: a, gravity: [0, 0, 0]}", False),
        ("{actuator_definitions: [], record: {}}", False),
        ("{world_scale: 20}", False),
        ("{}", False),
        ("[manipulators]", False),
        ("manipulators", False),
        ("~", False),
    ],
)
def test_a_scene_is_distinguished_from_a_definition_by_its_keys(text: str, is_scene: bool) -> None:
    assert scene_model.is_scene(parse(text, "a.yaml")) is is_scene


def test_a_definition_is_a_scene_of_itself() -> None:
    text = (DEFINITIONS / "finger.yaml").read_text("utf-8")
    alone = scene_from_text(text)
    by_name = scene_from_text("manipulators: [{definition: finger.yaml}]")
    assert alone == by_name
    assert alone.scale == Scale(20.0)


def test_the_scene_of_a_definition_points_into_the_definition() -> None:
    document = parse(json.dumps(BODY, indent=1), "body.json")
    made = scene_model.single_manipulator_scene(document)
    place = ("actuator_definitions", 0, "n_segments")
    assert made.span(("manipulators", 0, "definition", *place)) == document.span(place)
    for pointer in ((), ("manipulators",), ("manipulators", 0, "name"), ("gravity",)):
        assert made.span(pointer).source == "body.json"


@pytest.mark.parametrize(
    ("more", "added"),
    [
        ({}, ()),
        ({"ground": {}}, ("contact_force",)),
        ({"objects": [BALL]}, ("contact_force",)),
        ({"objects": [BALL | {"collides": False, "fixed": True}]}, ()),
        ({"manipulators": [ONE | {"base": "free"}]}, ("base_pose",)),
        ({"manipulators": [ONE | {"base": "free"}], "ground": {}}, ("base_pose", "contact_force")),
    ],
)
def test_what_is_recorded_unless_the_scene_says_so(
    more: dict[str, Any], added: tuple[str, ...]
) -> None:
    found = scene_from_text(json.dumps({"manipulators": [ONE], **more}))
    assert found.columns == ("joint_angles", "tip_position", *added)
    own = {"record": {"columns": ["energy"]}}
    assert scene_from_text(json.dumps({"manipulators": [ONE], **more, **own})).columns == (
        "energy",
    )
