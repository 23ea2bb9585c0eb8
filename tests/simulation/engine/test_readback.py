"""What the engine has read otherwise is reported, number by number."""

from __future__ import annotations

from dataclasses import replace

import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.simulation.engine.readback import EngineJoint, EngineLink, mismatches
from tests.builders.definitions import EVERYTHING, chain_of


@pytest.fixture(scope="module")
def chain() -> Chain:
    return chain_of(EVERYTHING)


def links_of(chain: Chain) -> list[EngineLink | None]:
    inertials = [link.inertial for link in chain.links]
    return [
        EngineLink(one.mass, one.centre, geometry.principal_moments(one.inertia))
        for one in inertials
    ]


def joints_of(chain: Chain) -> list[EngineJoint]:
    return [
        EngineJoint(index - 1, joint.axis, joint.lower, joint.upper)
        for index, joint in enumerate(chain.joints)
    ]


def test_what_was_understood_is_not_mentioned(chain: Chain) -> None:
    assert mismatches(chain, links_of(chain), joints_of(chain)) == []


def test_moments_may_come_in_any_order(chain: Chain) -> None:
    links = links_of(chain)
    assert links[1] is not None
    a, b, c = links[1].moments
    links[1] = replace(links[1], moments=(c, a, b))
    assert mismatches(chain, links, joints_of(chain)) == []


def test_a_base_that_cannot_move_has_no_mass(chain: Chain) -> None:
    assert mismatches(chain, [None, *links_of(chain)[1:]], joints_of(chain)) == []


def test_rounding_is_forgiven_and_more_is_not(chain: Chain) -> None:
    links = links_of(chain)
    assert links[0] is not None
    mass = links[0].mass
    links[0] = replace(links[0], mass=mass * (1 + 1e-12))
    assert mismatches(chain, links, joints_of(chain)) == []
    links[0] = replace(links[0], mass=mass * (1 + 1e-7))
    shown = f"[{mass:.6g}]"
    assert mismatches(chain, links, joints_of(chain)) == [
        f"mass of base is {shown} in the engine, {shown} in the file"
    ]


def test_every_number_is_compared(chain: Chain) -> None:
    def found(link: dict[str, object], joint: dict[str, object]) -> list[str]:
        links, joints = links_of(chain), joints_of(chain)
        links[2] = replace(links[2], **link)  # type: ignore[type-var, arg-type]
        joints[1] = replace(joints[1], **joint)  # type: ignore[arg-type]
        return [sentence.split(" is ")[0] for sentence in mismatches(chain, links, joints)]

    name, hinge = chain.links[2].name, chain.joints[1].name
    assert found({"mass": 0.0}, {}) == [f"mass of {name}"]
    assert found({"centre": (0.0, 0.0, 0.0)}, {}) == [f"centre of mass of {name}"]
    assert found({"moments": (1.0, 1.0, 1.0)}, {}) == [f"inertia of {name}"]
    assert found({"mass": float("nan")}, {}) == [f"mass of {name}"]
    assert found({}, {"parent": 3}) == [f"parent of {hinge}"]
    assert found({}, {"axis": (0.0, 0.0, 1.0)}) == [f"axis of {hinge}"]
    assert found({}, {"lower": -3.0 + 1e-6}) == [f"limits of {hinge}"]
    assert found({}, {"upper": 0.0}) == [f"limits of {hinge}"]
    assert found({"mass": 0.0}, {"parent": 3}) == [f"mass of {name}", f"parent of {hinge}"]
