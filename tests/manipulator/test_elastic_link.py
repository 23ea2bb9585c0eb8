"""Stiffness from the modulus, mass from the density: beams in closed form, and what is refused."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from somo_cli import loading
from somo_cli.manipulator.elastic_link import joint_stiffness
from somo_cli.manipulator.solids import Box, Cylinder
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import natural_frequencies
from tests.builders.definitions import Data, actuator, chain_of, hinge, manipulator
from tests.builders.scenes import DEFINITIONS

LENGTH, WIDTH, DEPTH, MODULUS, DENSITY = 0.1, 0.02, 0.015, 0.5e6, 1070.0
BENDING = MODULUS * WIDTH * DEPTH**3 / 12


def bare(*axis: float) -> Data:
    """Return a joint without a stiffness of its own."""
    joint = dict(hinge(*axis))
    del joint["spring_stiffness"]
    return joint


def beam(segments: int, *joints: Data, **changes: Any) -> Data:
    """Return a beam of that material."""
    link = {"shape_type": "box", "dimensions": [WIDTH, DEPTH, LENGTH / segments]}
    link |= {"density": DENSITY, "modulus": MODULUS, **changes}
    return manipulator(actuator(segments, *joints, link=link))


def test_a_cantilever_sags_as_a_beam() -> None:
    errors = []
    for segments in (10, 20, 40):
        chain = chain_of(beam(segments, bare(1, 0, 0)))
        heights = [0.5 * LENGTH / segments + index * LENGTH / segments for index in range(segments)]
        flexibility = sum(
            (LENGTH - height) ** 2 / joint.stiffness
            for height, joint in zip(heights, chain.joints, strict=True)
        )
        errors.append(flexibility / (LENGTH**3 / (3 * BENDING)) - 1)
    assert abs(errors[0]) < 3e-3
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)  # second order
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.05)


def test_its_first_frequency_is_that_of_a_beam() -> None:
    thin = 0.002  # m, so that the rotation of the sections counts for nothing
    chain = chain_of(beam(40, bare(1, 0, 0), dimensions=[WIDTH, thin, LENGTH / 40]))
    dynamics = ChainDynamics(chain)
    mass = dynamics.at(chain.neutral_angles).joint_inertia()
    first = natural_frequencies(mass, dynamics.stiffness)[0]
    bending = MODULUS * WIDTH * thin**3 / 12
    expected = 1.875104**2 * math.sqrt(bending / (DENSITY * WIDTH * thin)) / LENGTH**2
    assert first == pytest.approx(expected, rel=1e-3)


def test_axes_that_take_turns_stand_for_more_backbone_each() -> None:
    chain = chain_of(beam(10, bare(1, 0, 0), bare(0, 1, 0)))
    about_x, about_y = chain.joints[:2]
    assert about_x.stiffness == pytest.approx(BENDING / (2 * LENGTH / 10))
    assert about_y.stiffness == pytest.approx(MODULUS * DEPTH * WIDTH**3 / 12 / (2 * LENGTH / 10))


def test_what_is_given_by_hand_wins() -> None:
    chain = chain_of(beam(10, bare(1, 0, 0) | {"spring_stiffness": 0.0}, mass=1.0))
    assert all(joint.stiffness == 0 for joint in chain.joints)
    assert sum(link.inertial.mass for link in chain.links) == pytest.approx(10.0)


def test_the_mass_is_that_of_the_solid() -> None:
    chain = chain_of(beam(10, bare(1, 0, 0)))
    mass = sum(link.inertial.mass for link in chain.links)
    assert mass == pytest.approx(DENSITY * WIDTH * DEPTH * LENGTH)


def test_torsion_of_a_rod_is_that_of_saint_venant() -> None:
    link = {"shape_type": "cylinder", "modulus": 1e6, "poisson_ratio": 0.25}
    found = joint_stiffness(link, Cylinder(0.01, 0.005), (0, 0, 1), 0.01)
    assert found == pytest.approx(1e6 / 2.5 * math.pi / 2 * 0.005**4 / 0.01)
    rubber = joint_stiffness(link | {"poisson_ratio": None}, Cylinder(0.01, 0.005), (0, 0, 1), 0.01)
    assert rubber == pytest.approx(found * 2.5 / 3)


def test_a_square_is_as_stiff_about_any_axis_across() -> None:
    link = {"shape_type": "box", "modulus": 1e6}
    square = Box((0.01, 0.01, 0.02))
    about_x = joint_stiffness(link, square, (1, 0, 0), 0.02)
    assert joint_stiffness(link, square, (1, 2, 0), 0.02) == pytest.approx(about_x)


@pytest.mark.parametrize(
    ("joint", "changes", "message"),
    [
        (bare(1, 0, 0), {"modulus": None}, "missing key 'spring_stiffness'"),
        (bare(1, 0, 1), {}, "the axis is neither across the backbone nor along it"),
        (
            bare(1, 0, 0),
            {"shape_type": "sphere", "dimensions": [0.01]},
            "no stiffness follows from the modulus: a sphere has no section",
        ),
        (bare(1, 0, 0), {"density": None}, "missing key 'mass'"),
        (bare(1, 0, 0), {"modulus": -1}, "-1"),
    ],
)
def test_what_no_stiffness_or_mass_follows_from_is_an_error(
    joint: Data, changes: Data, message: str
) -> None:
    text = json.dumps(beam(4, joint, **changes))
    found = loading.check(loading.load_text(text, "beam.json"))
    assert [one.severity for one in found] == ["error"]
    assert message in found[0].message


def test_the_shipped_finger_is_as_stiff_as_its_comments_say() -> None:
    document = loading.load(str(DEFINITIONS / "silicone_finger.yaml"))
    (finger,) = loading.scene_of(document)[0].manipulators
    about_x, about_y = finger.compiled.chain.joints[:2]
    assert about_x.stiffness == pytest.approx(0.5e6 * 0.02 * 0.015**3 / 12 / 0.02)
    assert about_y.stiffness == pytest.approx(0.5e6 * 0.015 * 0.02**3 / 12 / 0.02)
    link = finger.compiled.chain.links[1].inertial.mass
    assert link == pytest.approx(1070 * 0.02 * 0.015 * 0.01)
