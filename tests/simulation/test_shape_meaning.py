"""What is wrong with the shape and the mass of an object."""

from __future__ import annotations

import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation import thing_shapes
from somo_cli.simulation.ground_meaning import lowest
from tests.manipulator.bodies import Data
from tests.simulation.test_compound import CUBE, PILL
from tests.simulation.test_things import told


def test_nothing_is_wrong_with_these() -> None:
    assert told(CUBE, PILL) == []
    assert told({**CUBE, "fixed": True}, {**PILL, "fixed": True}) == []


@pytest.mark.parametrize(
    ("thing", "message"),
    [
        ({**PILL, "dimensions": [1]}, "a capsule has 2 dimensions, found 1"),
        ({**PILL, "mass": 1}, "mass and density are two ways to say the same"),
        ({**PILL, "edge_radius": 1}, "edge_radius is for shape_type box, this one is capsule"),
        (
            {**CUBE, "edge_radius": 0.03},
            "0.03 m is not less than half the shortest edge, 0.03 m",
        ),
        (
            {key: value for key, value in CUBE.items() if key != "dimensions"},
            "a box needs dimensions",
        ),
        ({**CUBE, "position": [0, 0, 0.02]}, "it starts 0.01 m inside the ground"),
        ({**PILL, "position": [0, 0, 0.03]}, "it starts 0.01 m inside the ground"),
    ],
)
def test_what_is_wrong(thing: Data, message: str) -> None:
    assert told(thing, ground={}) == [message]


def test_the_lowest_point_of_what_is_round() -> None:
    tilted = geometry.rotation_from_rpy((0.7, 0.4, 0.2))
    for thing in (PILL, CUBE):
        (shape,) = thing_shapes.link(thing).shapes
        below = lowest(shape, Pose((0.0, 0.0, 1.0), tilted))
        x, y, z = tilted[2]
        if thing is PILL:
            assert below == pytest.approx(1 - 0.03 * abs(z) - 0.01)
        else:
            assert below == pytest.approx(1 - 0.025 * (abs(x) + abs(y) + abs(z)) - 0.005)
