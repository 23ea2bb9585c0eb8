"""Values of joint definitions: shared by the joints of an axis, or one for each joint."""

from __future__ import annotations

from somo_cli.calibration.joint_pointers import pointers, values
from somo_cli.document.parse import parse

EACH = """
actuator_definitions:
  - planar_flag: 2
    joint_definitions:
      - {joint_type: continuous}
      - {joint_type: fixed}
      - {joint_type: continuous}
"""
SHARED = "actuator_definitions: [{joint_definitions: [{joint_type: continuous}]}]\n"


def test_each_moving_joint_has_a_definition_of_its_own_with_planar_flag_2() -> None:
    places = pointers(parse(EACH, "a.yaml"), (), 0, 0)
    assert [place[-1] for place in places] == [0, 2]
    assert list(values(places, "spring_stiffness", [1.0, 0.5]).values()) == [1.0, 0.5]
    assert list(values(places, "torque_per_pressure", [1e-6]).values()) == [1e-6, 1e-6]


def test_a_shared_definition_gets_the_value_of_the_first_joint() -> None:
    places = pointers(parse(SHARED, "a.yaml"), (), 0, 0)
    assert values(places, "spring_stiffness", [0.123456789012, 0.5]) == {
        ("actuator_definitions", 0, "joint_definitions", 0, "spring_stiffness"): 0.123456789
    }
