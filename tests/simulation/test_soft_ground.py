"""Soft ground gives no energy to what rests, slides or rolls; exceptions are reported."""

from __future__ import annotations

import json

import numpy as np
import pytest

from somo_cli.loading import check, load_text, scene_of
from tests.builders.scenes import DEFINITIONS, scene_from_text
from tests.sliding.soft_ground import won
from tests.truth.surfaces import course

SOFT = {"contact_stiffness": 1000, "contact_damping": 5}


@pytest.mark.parametrize("step", [2.5e-4, 1e-3, 2e-3])
@pytest.mark.parametrize(
    ("body", "state"),
    [("capsule", "slides"), ("ball", "slides"), ("roll", "rests"), ("disc", "spins")],
)
def test_a_round_body_wins_less_than_a_hundredth(body: str, state: str, step: float) -> None:
    gain, _ = won(body, state, step, 0.6)
    assert gain < 0.01


def test_a_disc_without_friction_stays_flat() -> None:
    """On a point at its middle or one at its rim it tilted by 27 degrees."""
    _, tilt = won("disc", "slides", 1e-3, 2.0, friction=0.0)
    assert tilt < 0.5


@pytest.mark.moderate
def test_a_snake_that_lies_does_not_begin_to_roll() -> None:
    """The shipped one, light on its ground, left points of contact behind and rolled off."""
    snake = {
        "definition": "snake.yaml",
        "base": "free",
        "position": [-0.4, 0, 0.02],
        "rpy": [0, 1.5707963267948966, 0],
    }
    record = {"every": 100, "columns": ["energy"]}
    data = {"ground": SOFT, "manipulators": [snake], "record": record}
    found = course(scene_from_text(json.dumps(data)), 2e-3, 1.2)
    motion = next(value for name, value in found.items() if "kinetic" in name)
    assert motion[-1] < 1e-11
    # single rows may be a few 1e-12 J above the others, where another point of contact bears
    assert np.median(motion[len(motion) // 2 :]) < motion[len(motion) // 4]


def reported(**of_object: object) -> list[str]:
    rigid_object = {"name": "one", "mass": 0.1, "position": [0, 0, 1], **of_object}
    one = {"definition": "finger.yaml", "position": [5, 5, 0]}
    text = json.dumps({"ground": SOFT, "manipulators": [one], "objects": [rigid_object]})
    document = load_text(text, str(DEFINITIONS / "test.yaml"))
    assert scene_of(document)[1] == check(document)
    return [f"{one.severity} {one.code}" for one in check(document)]


@pytest.mark.parametrize(
    ("rigid_object", "is_reported"),
    [
        ({"shape_type": "cylinder", "dimensions": [0.02, 0.05]}, True),
        ({"shape_type": "box", "dimensions": [0.1, 0.1, 0.1], "edge_radius": 0.01}, True),
        ({"shape_type": "mesh", "mesh": "meshes/angle_foot.obj", "mesh_scale": 0.001}, True),
        ({"shape_type": "cylinder", "dimensions": [0.02, 0.05], "fixed": True}, False),
        ({"shape_type": "box", "dimensions": [0.1, 0.1, 0.1]}, False),
        ({"shape_type": "sphere", "dimensions": [0.1]}, False),
        ({"shape_type": "capsule", "dimensions": [0.1, 0.02]}, False),
    ],
)
def test_what_may_win_energy_is_reported(
    rigid_object: dict[str, object], is_reported: bool
) -> None:
    assert reported(**rigid_object) == (["warning late-springs"] if is_reported else [])
