"""Where the paths of parameters lead."""

from __future__ import annotations

import pytest

from somo_cli import loading
from somo_cli.sweep.targets import TargetError, pointers_of
from tests.builders.scenes import DEFINITIONS


@pytest.fixture(scope="module")
def lift() -> loading.Document:
    return loading.load(str(DEFINITIONS / "lift_scene.yaml"))


def test_items_have_names_and_indices(lift: loading.Document) -> None:
    expected = ("objects", 0, "dimensions", 1)
    assert pointers_of(lift, "objects[cube].dimensions[1]") == (expected,)
    assert pointers_of(lift, "objects[0].dimensions[1]") == (expected,)
    assert pointers_of(lift, "ground.restitution") == (("ground", "restitution"),)  # a new key


def test_a_file_is_reached_wherever_it_is_used(lift: loading.Document) -> None:
    path = "definition(finger.yaml).actuator_definitions[0].n_segments"
    below = ("actuator_definitions", 0, "n_segments")
    assert pointers_of(lift, path) == tuple(
        ("manipulators", number, "definition", *below) for number in (0, 1)
    )
    hand = loading.load(str(DEFINITIONS / "hand_scene.yaml"))
    found = pointers_of(hand, "definition(finger.yaml).world_scale")
    assert len(found) > 2
    assert {pointer[-3] for pointer in found} <= {"definition", *range(9)} | {"limbs"}


@pytest.mark.parametrize(
    ("path", "message", "hint"),
    [
        ("objects[cub].mass", "no item called 'cub'", "did you mean 'cube'?"),
        ("objects[1].mass", "no item [1]", "the last one is [0]"),
        ("objects[cube].mas.x", "no 'mas'", "did you mean 'mass'?"),
        ("ground[0]", "[0] is not in a list", ""),
        ("definition(fingr.yaml).x", "uses no file 'fingr.yaml'", "did you mean 'finger.yaml'?"),
        ("definition(finger.yaml)", "names no value", "objects[ball].mass"),
        ("objects[", "is not a path", "objects[ball].mass"),
    ],
)
def test_a_path_that_leads_nowhere(
    lift: loading.Document, path: str, message: str, hint: str
) -> None:
    with pytest.raises(TargetError) as caught:
        pointers_of(lift, path)
    assert message in str(caught.value)
    assert hint in caught.value.hint
