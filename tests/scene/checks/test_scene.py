"""Problems that the checks find in a scene; each list is complete. tests/cases has their text."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from somo_cli import loading
from somo_cli.manipulator import assembly_chain
from somo_cli.manipulator import compile as compiler
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.definition import Definition
from tests.builders.definitions import X, Y, actuator, hinge, manipulator
from tests.builders.scene_problems import texts_and_messages

BODY = manipulator(actuator(2, X, Y), actuator(1, X))
TextAndMessage = tuple[str, str]  # the text at the place, the message


def manipulator_problems(
    *, in_scene: dict[str, Any] | None = None, **of_manipulator: Any
) -> list[TextAndMessage]:
    return texts_and_messages(
        {"manipulators": [{"definition": BODY, **of_manipulator}], **(in_scene or {})}
    )


def drive_problems(**of_drive: Any) -> list[TextAndMessage]:
    return manipulator_problems(actuation=[{"actuator": 0, "axis": 0, **of_drive}])


def test_a_valid_scene_has_no_problems() -> None:
    assert manipulator_problems() == []
    assert (
        manipulator_problems(
            base="free",
            linear_velocity=[1, 2, 3],
            angular_velocity=[1, 2, 3],
            initial_angles=[0.1, 0.2, 0.3],
            initial_rates=4,
            actuation=[
                {"actuator": 1, "axis": 0, "torque": 1},
                {"actuator": 0, "axis": 1, "waypoints": [[-1, 0], [2, 3]]},
            ],
        )
        == []
    )


def test_a_problem_in_a_definition_is_reported_at_its_position() -> None:
    two_axes = manipulator(actuator(2, X, Y, planar_flag=1))
    assert [text for text, _ in manipulator_problems(definition=two_axes)] == [
        '"joint_definitions"'
    ]


def test_a_base_that_is_held_has_no_velocity() -> None:
    message = "{} is for a free base, and this one is {}"
    for key in ("linear_velocity", "angular_velocity"):
        for base in ("static", "constrained"):
            said = (f'"{key}"', message.format(key, base))
            assert manipulator_problems(**{key: [0, 0, 1], "base": base}) == [said]
        assert manipulator_problems(**{key: [0, 0, 1], "base": "free"}) == []


def test_a_drive_has_torque_or_waypoints() -> None:
    assert [message for _, message in drive_problems()] == [
        "missing torque, pressure, wave, trajectory or waypoints"
    ]
    both = drive_problems(torque=1, waypoints=[[0, 1]])
    assert both == [('"waypoints"', "both torque and waypoints are given")]
    for key, value in (("interpolation", "cubic"), ("repeat", True)):
        assert drive_problems(torque=1, **{key: value}) == [
            (f'"{key}"', f"{key} has no meaning beside a constant torque")
        ]


def driven(per_pressure: list[float | None], **of_drive: Any) -> list[TextAndMessage]:
    joints = [hinge(1, 0, 0, torque_per_pressure=value) for value in per_pressure]
    body = manipulator(actuator(len(joints), *joints, planar_flag=2))
    entry = {"actuator": 0, "axis": 0, **of_drive}
    return manipulator_problems(definition=body, actuation=[entry])


def test_pressure_needs_to_be_known_as_torque() -> None:
    for drive, key in (
        ({"pressure": 1e5}, '"pressure"'),
        ({"waypoints": [[0, 1e5]], "input": "pressure"}, '"input"'),
    ):
        assert driven([5e-7, 5e-7], **drive) == []
        none = (key, "the joints of actuator 0, axis 0 have no torque_per_pressure")
        assert driven([None, None], **drive) == [none]
        differing = (key, "the joints of actuator 0, axis 0 differ in torque_per_pressure")
        assert driven([5e-7, 6e-7], **drive) == [differing]
    assert driven([None, None], waypoints=[[0, 1]], input="torque") == []


def test_a_drive_has_one_input() -> None:
    assert driven([1.0, 1.0], torque=1, pressure=1) == [
        ('"pressure"', "both torque and pressure are given")
    ]
    assert driven([1.0, 1.0], pressure=1, input="pressure") == [
        ('"input"', "input has no meaning beside a constant pressure")
    ]
    cubic = {"interpolation": "cubic", "repeat": True, "input": "pressure"}
    assert [message for _, message in driven([1.0, 1.0], waypoints=[[0, 1], [1, 2]], **cubic)] == [
        "repeated cubic waypoints must end with the pressure they start with, 1 Pa, not 2 Pa"
    ]


def test_times_increase() -> None:
    found = drive_problems(waypoints=[[0, 1], [2, 1], [2, 3], [1, 0], [5, 0]])
    assert [message for _, message in found] == [
        "time 2 s does not come after 2 s",
        "time 1 s does not come after 2 s",
    ]


@pytest.mark.parametrize(
    ("points", "interpolation", "messages"),
    [
        ([[0, 1], [1, 2]], "linear", []),
        ([[0.5, 1], [1, 2]], "step", []),
        ([[0, 1], [1, 2], [3, 1]], "cubic", []),
        ([[-1, 1], [1, 2]], "linear", ["repeated waypoints start at time -1 s, before 0"]),
        ([[0, 1]], "step", ["repeated waypoints have a period of 0 s"]),
        ([[0.5, 1], [1, 1]], "cubic", ["repeated cubic waypoints must start at time 0, not 0.5 s"]),
        (
            [[0, 1], [1, 2]],
            "cubic",
            ["repeated cubic waypoints must end with the torque they start with, 1 N·m, not 2 N·m"],
        ),
        (
            [[-2, 1], [-1, 1]],
            "linear",
            [
                "repeated waypoints start at time -2 s, before 0",
                "repeated waypoints have a period of -1 s",
            ],
        ),
    ],
)
def test_what_repeats(points: list[list[float]], interpolation: str, messages: list[str]) -> None:
    found = drive_problems(waypoints=points, interpolation=interpolation, repeat=True)
    assert [message for _, message in found] == messages


def test_numbers_for_every_joint() -> None:
    found = manipulator_problems(initial_angles=[0, 0], initial_rates=[0, 0, 0, 0])
    assert [message for _, message in found] == [
        "initial_angles has 2 values for 3 joints",
        "initial_rates has 4 values for 3 joints",
    ]


def test_a_joint_starts_within_its_limits() -> None:
    assert manipulator_problems(initial_angles=[0, 3.5, -4]) == [
        ("3.5", "joint 'actuator_0_joint_02' starts at 3.5 rad, outside its limits [-3, 3]"),
        ("-4", "joint 'actuator_1_joint_01' starts at -4 rad, outside its limits [-3, 3]"),
    ]
    assert manipulator_problems(initial_angles=3.5) == [
        ("3.5", "joint 'actuator_0_joint_01' starts at 3.5 rad, outside its limits [-3, 3]")
    ]
    away = manipulator(actuator(1, hinge(1, 0, 0, limits=[0.5, 1, 1, 1])))
    assert manipulator_problems(definition=away) == [
        (
            '"definition"',
            "joint 'actuator_0_joint_01' starts at 0 rad, outside its limits [0.5, 1]",
        )
    ]
    assert manipulator_problems(definition=away, initial_angles=0.5) == []
    endless = manipulator(actuator(1, {**X, "joint_type": "continuous", "limits": None}))
    assert manipulator_problems(definition=endless, initial_angles=99) == []


def test_what_is_driven_exists() -> None:
    drives = [(2, 0), (1, 1), (0, 0), (0, 1), (0, 0)]
    found = manipulator_problems(
        actuation=[{"actuator": a, "axis": x, "torque": 1} for a, x in drives]
    )
    assert [message for _, message in found] == [
        "there is no actuator 2",
        "actuator 1 has no axis 1",
        "actuator 0, axis 0 is driven twice",
    ]


def test_a_load_is_on_a_link_and_does_something() -> None:
    push = {"force": [1, 0, 0]}
    found = manipulator_problems(
        loads=[
            {**push, "link": "tip"},
            {**push, "link": "actuator_0_segment_02"},
            {**push, "link": "actuator_0_segment_2"},
            {"link": "actuator_1_segment_01"},
            {**push, "link": "base"},
            {"force": [0, 0, 0], "moment": [0, 0, 0]},
            {"moment": [0, 0, 1], "waypoints": [[0, 0], [1, -1]]},
        ]
    )
    assert [message for _, message in found] == [
        "there is no link 'actuator_0_segment_2'",
        "missing force or moment",
        "a load on the base does nothing, because the base is static",
        "this load is zero at all times",
    ]
    assert manipulator_problems(loads=[{**push, "link": "base"}], base="free") == []


def test_waypoints_of_a_load_are_checked_like_those_of_a_torque() -> None:
    points = {"waypoints": [[0, 1], [0, 1], [2, 0.5]], "interpolation": "cubic", "repeat": True}
    messages = [
        message for _, message in manipulator_problems(loads=[{"force": [1, 0, 0], **points}])
    ]
    assert messages == [
        "time 0 s does not come after 0 s",
        "repeated cubic waypoints must end with the factor they start with, 1, not 0.5",
    ]


def test_names_are_unique() -> None:
    message = "two manipulators are called 'body'"
    twice = [{"definition": BODY}, {"definition": BODY}]
    assert texts_and_messages({"manipulators": twice}) == [('"definition"', message)]
    named = [{"definition": BODY}, {"definition": BODY, "name": "body"}]
    assert texts_and_messages({"manipulators": named}) == [('"body"', message)]
    assert (
        texts_and_messages({"manipulators": [{"definition": BODY}, {**twice[0], "name": "b"}]})
        == []
    )


def test_definitions_agree_on_the_scale_or_the_scene_decides() -> None:
    twenty = {"name": "b", "definition": {**BODY, "world_scale": 20}}
    heavy = {"name": "c", "definition": {**BODY, "world_scale": {"length": 1, "mass": 5}}}
    one = {"definition": BODY}
    message = "this definition has world_scale {}, the first one 1"
    assert texts_and_messages({"manipulators": [one, twenty, heavy]}) == [
        ('"definition"', message.format("20")),
        ('"definition"', message.format("1 (mass 5)")),
    ]
    assert texts_and_messages({"manipulators": [one, twenty], "world_scale": 3}) == []


def test_a_scene_is_no_definition() -> None:
    scene = {"manipulators": [{"definition": BODY}]}
    assert texts_and_messages({"manipulators": [{"definition": scene}]}) == [
        ('"manipulators"', "this is a scene, not a manipulator definition")
    ]


def test_all_problems_come_at_once_and_in_reading_order() -> None:
    found = manipulator_problems(
        linear_velocity=[0, 0, 1],
        initial_angles=[0],
        actuation=[{"actuator": 0, "axis": 0}, {"actuator": 5, "axis": 0, "torque": "much"}],
        in_scene={"time_step": 0, "colour": "red"},
    )
    assert [message for _, message in found] == [
        "linear_velocity is for a free base, and this one is static",
        "initial_angles has 1 values for 3 joints",
        "missing torque, pressure, wave, trajectory or waypoints",
        "expected a number, found the string 'much'",
        "0 must be greater than 0",
        "unknown key 'colour'",
    ]


@pytest.mark.moderate
@pytest.mark.parametrize("value", [None, 3, "text", [], {}, [1], [[1]], [None], True])
@pytest.mark.parametrize(
    "place",
    [
        (),
        ("manipulators",),
        ("manipulators", 0),
        *(
            ("manipulators", 0, key)
            for key in ("definition", "name", "base", "initial_angles", "actuation", "loads", "rpy")
        ),
        ("manipulators", 0, "actuation", 0),
        ("manipulators", 0, "actuation", 0, "waypoints"),
        ("manipulators", 0, "loads", 0),
        *(
            ("manipulators", 0, "loads", 0, key)
            for key in ("link", "point", "force", "moment", "frame", "waypoints", "repeat")
        ),
        ("manipulators", 0, "definition", "actuator_definitions"),
        ("manipulators", 0, "definition", "world_scale"),
        ("record",),
        ("world_scale",),
    ],
)
def test_no_value_at_all_makes_it_stumble(place: tuple[str | int, ...], value: object) -> None:
    sound: Any = {
        "manipulators": [
            {
                "definition": BODY,
                "actuation": [{"actuator": 0, "axis": 0, "waypoints": [[0, 1], [1, 2]]}],
                "loads": [
                    {
                        "link": "base",
                        "point": [0, 0, 1],
                        "force": [1, 0, 0],
                        "moment": [0, 1, 0],
                        "frame": "body",
                        "waypoints": [[0, 1], [1, 1]],
                        "interpolation": "cubic",
                        "repeat": True,
                    }
                ],
            },
            {"definition": BODY, "name": "other"},
        ]
    }
    data = json.loads(json.dumps({"all": sound}))
    at = data
    *outer, last = ("all", *place)
    for step in outer:
        at = at[step]
    at[last] = value
    texts_and_messages(data["all"])


def test_each_definition_is_compiled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    path = Path(__file__).parents[3] / "definitions" / "in_hand_scene.yaml"
    document = loading.load(str(path))
    built: list[str] = []

    def build(definition: Definition) -> Chain:
        built.append(definition.name)
        return assembly_chain.build(definition)

    monkeypatch.setattr(compiler, "assembly_chain", SimpleNamespace(build=build))
    scene, _ = loading.scene_of(document)
    assert built == [one.compiled.definition.name for one in scene.manipulators]
    assert len(built) == 4


def test_a_scene_has_a_bounded_number_of_bodies() -> None:
    ball = {"shape_type": "sphere", "dimensions": [0.1], "mass": 1}
    balls = [{**ball, "name": f"ball_{index}"} for index in range(1001)]
    found = texts_and_messages({"objects": balls})
    assert [message for _, message in found] == ["expected at most 1000 values, found 1001"]
