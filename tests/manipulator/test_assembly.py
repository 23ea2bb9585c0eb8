"""What an assembly is, and what is read from one."""

from __future__ import annotations

import pytest

from somo_cli.manipulator import assembly
from somo_cli.manipulator.dimensions import Scale
from tests.builders.assemblies import assembly_of
from tests.builders.definitions import BOX, SPHERE, X, Y, Z, actuator, document_of, manipulator

ONE = manipulator(actuator(4, X, Y), base_definition=BOX, tip_definition=SPHERE)
TWO = manipulator(actuator(2, Z), actuator(3, X))


def test_an_assembly_is_recognised_by_its_keys() -> None:
    assert assembly.is_assembly(assembly_of())
    assert assembly.is_assembly({"limbs": []})
    assert not assembly.is_assembly(ONE)
    assert not assembly.is_assembly({"limbs": [], "actuator_definitions": []})
    assert not assembly.is_assembly({"limbs": [], "manipulators": []})
    assert not assembly.is_assembly(["limbs"])


def test_actuators_are_those_of_limb_after_limb() -> None:
    limbs = [
        {"name": "a", "definition": TWO, "position": [1, 2, 3]},
        {"name": "b", "definition": ONE, "rpy": [0.1, 0.2, 0.3]},
    ]
    found = assembly.read(document_of(assembly_of(limbs=limbs)))
    assert [one.n_segments for one in found.actuators] == [2, 3, 4]
    assert (found.actuators_of("a"), found.actuators_of("b")) == (range(0, 2), range(2, 3))
    assert [limb.position for limb in found.limbs] == [(1, 2, 3), (0, 0, 0)]
    assert [limb.rpy for limb in found.limbs] == [(0, 0, 0), (0.1, 0.2, 0.3)]
    assert [limb.base is None for limb in found.limbs] == [True, False]
    assert [len(limb.tips) for limb in found.limbs] == [0, 1]
    with pytest.raises(KeyError):
        found.actuators_of("c")


def test_a_manipulator_is_read_as_ever() -> None:
    assert assembly.read(document_of(TWO)).limbs == ()


def test_the_scale_is_the_assemblys_own_else_the_limbs() -> None:
    limb = {"name": "only", "definition": {**ONE, "world_scale": 20}}
    for changes, scale in (({}, Scale(20)), ({"world_scale": 5}, Scale(5))):
        document = document_of(assembly_of(limbs=[limb], **changes))
        assert assembly.world_scale(document) == scale
    assert assembly.world_scale(document_of(assembly_of())) is None
