from __future__ import annotations

import pytest

from somo_cli.manipulator import read, urdf
from somo_cli.manipulator.chain_build import build_chain
from somo_cli.manipulator.compile import compile_definition, compile_sound, document_problems
from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.problems import InvalidFile
from tests.builders.definitions import (
    BOX,
    CYLINDER,
    EVERYTHING,
    X,
    actuator,
    compiled,
    document_of,
    hinge,
    manipulator,
)


def test_from_document_to_text() -> None:
    found = compiled({**EVERYTHING, "world_scale": {"length": 20, "mass": 3}})
    document = document_of(EVERYTHING)
    assert found.definition == read.read(document)
    assert found.chain == build_chain(found.definition)
    assert found.scale == Scale(20.0, 3.0)
    assert found.scaled_chain(Scale(2.0)) == scaled(found.chain, Scale(2.0))


def test_the_scale_asked_for_goes_before_that_of_the_file() -> None:
    plain, large = compiled(EVERYTHING), compiled({**EVERYTHING, "world_scale": 20})
    assert plain.scale is None
    assert plain.chain == large.chain
    assert plain.urdf() == plain.urdf(Scale()) == urdf.render(plain.chain)
    note = urdf.scale_note(Scale(20.0))
    in_engine_units = urdf.render(scaled(plain.chain, Scale(20.0)), note=note)
    assert large.urdf() == plain.urdf(Scale(20.0)) == in_engine_units
    assert note.startswith("<!-- World scale 20, ")
    assert note in in_engine_units
    assert "<!--" not in plain.urdf()
    assert large.urdf(Scale()) == plain.urdf()
    assert large.urdf(tip_frame="tip") == plain.urdf(Scale(20.0), "tip")


def test_a_line_about_it() -> None:
    data = manipulator(actuator(3, X), base_definition=CYLINDER)
    assert compiled(data).described(Scale(20.0)) == (
        "4 links, 3 joints, 0.013 kg, 0.08 m long, world scale 20"
    )


def test_errors_of_schema_and_of_checks_come_together() -> None:
    data = manipulator(
        actuator(3, hinge(0, 0, 0), link={**BOX, "mass": -1}), n_act=2, manipulator_nam="x"
    )
    document = document_of(data)
    with pytest.raises(InvalidFile) as caught:
        compile_definition(document)
    assert caught.value.texts == document.texts
    assert [problem.message for problem in caught.value.problems] == [
        "-1 must be greater than 0",
        "axis [0, 0, 0] has no length",
        "n_act is 2, but actuator_definitions has 1",
        "unknown key 'manipulator_nam'",
    ]


def test_warnings_do_not_stop_it() -> None:
    data = manipulator(actuator(1, X, link={**CYLINDER, "dimensions": [0.02, 0.01, 5]}))
    document = document_of(data)
    found = compile_definition(document)
    assert [problem.message for problem in found.warnings] == [
        "a cylinder has [height, radius]; the third value is ignored"
    ]
    assert tuple(found.warnings) == document_problems(document)


def test_a_valid_document_has_no_problems() -> None:
    assert document_problems(document_of(EVERYTHING)) == ()


def test_a_definition_inside_a_scene() -> None:
    document = document_of({"manipulators": [{"definition": {**EVERYTHING, "world_scale": 5}}]})
    found = compile_sound(document, ("manipulators", 0, "definition"), ())
    assert found == compiled({**EVERYTHING, "world_scale": 5})
