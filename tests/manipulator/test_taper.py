"""Tapered actuators: deflection and mass in closed form, and what is refused."""

from __future__ import annotations

import json
from typing import Any

import pytest

from somo_cli import loading
from somo_cli.manipulator import resegmentation
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.solids import Box
from tests.builders.definitions import Data, X, actuator, chain_of, compiled, hinge, manipulator

LENGTH, WIDTH, DEPTH, MODULUS, DENSITY, TAPER = 0.1, 0.02, 0.015, 0.5e6, 1070.0, 0.4


def tapered(segments: int, taper: float = TAPER, **changes: Any) -> Data:
    """Return a beam of that material which gets thinner."""
    link = {"shape_type": "box", "dimensions": [WIDTH, DEPTH, LENGTH / segments]}
    link |= {"density": DENSITY, "modulus": MODULUS, **changes}
    joint = {key: value for key, value in X.items() if key != "spring_stiffness"}
    return manipulator(actuator(segments, joint, link=link, taper=taper))


def sag(chain: Chain, segments: int) -> float:
    """Return the deflection of the tip per force across it [m/N], linear."""
    places = [(index + 0.5) * LENGTH / segments for index in range(segments)]
    joints = zip(places, chain.joints, strict=True)
    return sum((LENGTH - place) ** 2 / joint.stiffness for place, joint in joints)


def test_it_sags_as_a_tapered_cantilever() -> None:
    # P L³ / (3 E I t), with I at the clamp: the integral of (1 - s)² / (1 - (1 - t) s)⁴ is 1 / 3t
    exact = LENGTH**3 / (3 * MODULUS * WIDTH * DEPTH**3 / 12 * TAPER)
    errors = [sag(chain_of(tapered(count)), count) / exact - 1 for count in (10, 40, 80)]
    assert abs(errors[0]) < 0.02
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.1)  # second order


def test_its_mass_is_that_of_a_frustum() -> None:
    exact = DENSITY * WIDTH * DEPTH * LENGTH * (1 + TAPER + TAPER**2) / 3
    mass = sum(link.inertial.mass for link in chain_of(tapered(40)).links)
    assert mass == pytest.approx(exact, rel=1e-3)


def test_links_get_thinner_from_base_to_tip() -> None:
    chain = chain_of(tapered(10))
    solids = [shape.solid for link in chain.links for shape in link.shapes]
    widths = [solid.size[0] for solid in solids if isinstance(solid, Box)]
    assert widths == sorted(widths, reverse=True)
    assert widths[0] == pytest.approx(WIDTH * (1 - 0.6 * 0.025))
    assert widths[-1] == pytest.approx(WIDTH * (1 - 0.6 * 0.975))
    assert chain.length == pytest.approx(LENGTH)


def test_another_number_of_segments_is_the_same_body() -> None:
    cut = resegmentation.cut(compiled(tapered(10)), 40)
    directly = compiled(tapered(40))
    for one, other in zip(cut.chain.joints, directly.chain.joints, strict=True):
        assert one.stiffness == pytest.approx(other.stiffness)
    for link, same in zip(cut.chain.links, directly.chain.links, strict=True):
        assert link.inertial.mass == pytest.approx(same.inertial.mass)


def test_a_taper_of_one_changes_nothing() -> None:
    assert chain_of(tapered(10, 1.0)) == chain_of(tapered(10, None))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"shape_type": "sphere", "dimensions": [0.005], "modulus": None}, "spheres cannot have"),
        ({"inertial_values": [1e-7, 0, 0, 1e-7, 0, 1e-7]}, "exclude each other"),
    ],
)
def test_what_cannot_taper_is_an_error(changes: Data, message: str) -> None:
    data = tapered(10, **changes)
    data["actuator_definitions"][0]["joint_definitions"] = [hinge(1, 0, 0)]
    found = loading.check(loading.load_text(json.dumps(data), "beam.json"))
    assert [message in one.message for one in found if one.severity == "error"] == [True]
