"""Measured columns and the columns of a run; each list of problems is the whole list."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from somo_cli.calibration.measurement import Measurement, measurement, scene_recording, time_window
from somo_cli.document.table import read_table
from somo_cli.problems import InvalidFile
from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import X, Y, actuator, manipulator
from tests.builders.scenes import scene_from_text

SCENE = scene_from_text(
    json.dumps({"manipulators": [{"definition": manipulator(actuator(2, X, Y))}]})
)


def recorded(text: str, *chosen: str) -> Measurement:
    return measurement(read_table(text, "a.csv"), SCENE, chosen)


def problems(text: str, *chosen: str) -> list[tuple[int, int, str]]:
    with pytest.raises(InvalidFile) as error:
        recorded(text, *chosen)
    found = error.value.problems
    return [(one.span.line, one.span.column, one.message) for one in found]


def test_columns_are_found_by_their_names() -> None:
    text = "time_s,tip.z_m,body.actuator_0_joint_02.angle_rad,tip.x_m\n0,1,2,3\n0.1,4,5,6\n"
    found = recorded(text)
    assert found.quantities == ("joint_angles", "tip_position")
    assert found.names == ("body.tip.z_m", "body.actuator_0_joint_02.angle_rad", "body.tip.x_m")
    assert found.values.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert found.times.tolist() == [0, 0.1]
    header = columns.header(
        make_plan(dataclasses.replace(SCENE, columns=found.quantities)).recorded
    )
    assert [header[place] for place in found.places] == list(found.names)
    assert [found.quantities[owner] for owner in found.owners] == [
        "tip_position",
        "joint_angles",
        "tip_position",
    ]


def test_what_the_scene_itself_picks_and_where_it_stops_does_not_matter() -> None:
    cube = {
        "name": "cube",
        "shape_type": "sphere",
        "dimensions": [0.1],
        "mass": 1,
        "position": [5, 0, 0],
    }
    data = {
        "manipulators": [{"definition": manipulator(actuator(2, X, Y))}],
        "objects": [cube],
        "record": {"only": ["body.tip.y_m"], "events": True},
        "stop": [{"time": 0.05}],
    }
    scene = scene_from_text(json.dumps(data))
    table = read_table("time_s,cube.pose.z_m,tip.x_m\n0,1,2\n0.1,4,5\n", "a.csv")
    found = measurement(table, scene, ())
    assert found.names == ("cube.pose.z_m", "body.tip.x_m")
    assert found.quantities == ("tip_position", "base_pose")
    whole = scene_recording(scene, found.quantities)
    header = columns.header(make_plan(whole).recorded)
    assert [header[place] for place in found.places] == list(found.names)
    assert (whole.only, whole.stop_conditions, whole.has_contact_events) == ((), (), False)
    force = read_table("time_s,cube.contact.fx_n\n0,1\n0.1,4\n", "a.csv")
    with pytest.raises(InvalidFile, match=r"the scene records no column 'cube\.contact\.fx_n'"):
        measurement(force, scene, ())


def test_only_the_chosen_ones_count() -> None:
    text = "time_s,tip.x_m,force_n\n0,1,2\n0.1,4,5\n"
    assert recorded(text, "tip.x_m").names == ("body.tip.x_m",)
    assert recorded(text, "body.tip.x_m").names == ("body.tip.x_m",)
    full = text.replace("tip.x_m", "body.tip.x_m")
    assert recorded(full, "tip.x_m").names == ("body.tip.x_m",)
    assert problems(text, "tip.y_m", "tip.z_m") == [
        (1, 1, "there is no column 'tip.y_m'"),
        (1, 1, "there is no column 'tip.z_m'"),
    ]
    assert problems(text) == [(1, 16, "the scene records no column 'force_n'")]


def test_problems_are_reported_all_at_once() -> None:
    text = "time_s,tip.x_m,tp.y_m,body.tip.x_m,energy.kinetic_j\n-0.1,1,2,3,4\n0,1,2,3,4\n"
    assert problems(text) == [
        (1, 16, "the scene records no column 'tp.y_m'"),
        (1, 23, "'body.tip.x_m' and 'tip.x_m' are the same column"),
        (1, 36, "the scene records no column 'energy.kinetic_j'"),
        (2, 1, "time -0.1 s is before the start"),
    ]
    assert problems("time_s\n0\n1\n") == [(1, 1, "there is no column besides time_s")]


def test_a_quantity_has_one_weight() -> None:
    text = "time_s,tip.x_m,actuator_0_joint_01.angle_rad,tip.z_m\n0,1,2,3\n0.1,4,5,6\n"
    weights = recorded(text).weights(np.array([[1.0, 0.1, 0.0], [-1.0, 0.1, 0.0]]))
    assert weights == pytest.approx([np.sqrt(2), 10, np.sqrt(2)])


def test_between_two_times() -> None:
    table = read_table("time_s,x\n0,1\n1,2\n2,3\n3,4\n", "a.csv")
    times, values = time_window(table, "x", 1.0, 2.5)
    assert (times.tolist(), values.tolist()) == ([1, 2], [2, 3])
