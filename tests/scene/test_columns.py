"""Names of the columns, and which of them belong together."""

from __future__ import annotations

import json

import pytest

from somo_cli.scene import columns
from somo_cli.scene.model import Quantity
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import EVERYTHING, X, Y, actuator, manipulator
from tests.builders.recorded_columns import COLUMN_NAMES, QUANTITIES, plan_that_records
from tests.builders.scenes import scene_from_text

SMALL = manipulator(actuator(2, X, Y), actuator(1, X))


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_the_names_of_a_quantity(quantity: Quantity) -> None:
    expected = ["time_s", *(f"a.{name}" for name in COLUMN_NAMES[quantity])]
    assert columns.header(plan_that_records(SMALL, quantity).recorded) == expected


def test_the_columns_come_in_the_order_of_the_scene() -> None:
    found = columns.header(plan_that_records(SMALL, "tip_position", "joint_angles").recorded)
    names = [*COLUMN_NAMES["tip_position"], *COLUMN_NAMES["joint_angles"]]
    assert found == ["time_s", *(f"a.{name}" for name in names)]


def test_every_name_is_its_own() -> None:
    two = [{"name": name, "definition": EVERYTHING} for name in ("a", "b")]
    text = json.dumps({"manipulators": two, "record": {"columns": QUANTITIES}})
    found = columns.header(make_plan(scene_from_text(text)).recorded)
    assert len(set(found)) == len(found)
    found = [name.replace(".contact.b.", ".contact.a.") for name in found]  # of the other
    assert [name.replace("b.", "a.", 1) for name in found if name.startswith("b.")] == [
        name for name in found if name.startswith("a.")
    ]


def test_the_groups_are_the_columns_of_each_quantity() -> None:
    two = [{"name": name, "definition": SMALL} for name in ("a", "b")]
    text = json.dumps({"manipulators": two, "record": {"columns": ["tip_position", "energy"]}})
    plan = make_plan(scene_from_text(text))
    names = columns.header(plan.recorded)
    found = [
        (one.body, one.quantity, names[one.first : one.last])
        for one in columns.body_column_groups(plan.recorded)
    ]
    assert found == [
        (number, quantity, [f"{name}.{one}" for one in COLUMN_NAMES[quantity]])
        for number, name in enumerate("ab")
        for quantity in ("tip_position", "energy")
    ]
