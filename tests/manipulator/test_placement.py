"""Where joints stand: the rules, the layouts, and what a chain made by them keeps."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from somo_cli.manipulator import compile as compiler
from somo_cli.manipulator.joint_placement import gauss, layout
from somo_cli.manipulator.resegmentation import cut
from tests.builders.definitions import (
    BOX,
    SPHERE,
    Data,
    X,
    Y,
    Z,
    actuator,
    compiled,
    document_of,
    manipulator,
)

COUNTS = (1, 2, 3, 5, 20, 121)


@pytest.mark.parametrize("count", COUNTS)
def test_without_a_shift_the_points_are_those_of_gauss_and_legendre(count: int) -> None:
    points, weights = np.array(gauss(count)).T
    theirs = np.polynomial.legendre.leggauss(count)
    assert points == pytest.approx((theirs[0] + 1) / 2, abs=2e-15)
    # numpy's own lose digits with many points, some versions more than others
    assert weights == pytest.approx(theirs[1] / 2, abs=2e-14)


@pytest.mark.parametrize("shift", [-0.5, -0.2, 0.4, 0.9])
@pytest.mark.parametrize("count", COUNTS)
def test_a_shifted_rule_is_exact_to_one_degree_less(count: int, shift: float) -> None:
    points, weights = np.array(gauss(count, shift)).T
    assert (weights > 0).all()
    assert ((points > 0) & (points < 1)).all()
    for degree in range(2 * count - 1):
        assert weights @ points**degree == pytest.approx(1 / (degree + 1), abs=1e-13)
    next_one = weights @ points ** (2 * count - 1) - 1 / (2 * count)
    if count <= 5:
        assert abs(next_one) > 1e-9


def test_opposite_shifts_mirror_the_rule() -> None:
    one, other = gauss(7, 0.4), gauss(7, -0.4)
    for (place, weight), (mirrored, same) in zip(one, reversed(other), strict=True):
        assert (place, weight) == (pytest.approx(1 - mirrored), pytest.approx(same))


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_the_joints_of_several_axes_keep_their_turns(axes: int) -> None:
    for count in range(axes, 122):
        turns = [number % axes for number in range(count)]
        where = layout("gauss", turns, axes)
        assert min(where.fractions) > 0
        assert math.fsum(where.fractions) == pytest.approx(count)
        for axis in range(axes):
            shares = [
                share for turn, share in zip(turns, where.shares, strict=True) if turn == axis
            ]
            assert math.fsum(shares) == pytest.approx(count / axes)


def test_evenly_placed_joints_stand_between_halves() -> None:
    where = layout("uniform", [0, 1, 0, 1], 2)
    assert where.places == (0.125, 0.375, 0.625, 0.875)
    assert where.fractions == (0.5, 1, 1, 1, 0.5)
    assert where.shares == (1, 1, 1, 1)


@pytest.mark.parametrize("joints", [(X,), (X, Y), (X, Y, Z)])
def test_a_chain_at_gauss_points_keeps_length_mass_and_rigidity(joints: tuple[Data, ...]) -> None:
    even = compiled(manipulator(actuator(6, *joints))).chain
    chain = compiled(manipulator(actuator(6, *joints, joint_placement="gauss"))).chain
    assert chain.length == pytest.approx(even.length)
    masses = [sum(link.inertial.mass for link in one.links) for one in (chain, even)]
    assert masses[0] == pytest.approx(masses[1])
    places = np.cumsum([joint.origin[2] for joint in chain.joints])
    turns = [number % len(joints) for number in range(6)]
    where = layout("gauss", turns, len(joints))
    assert places == pytest.approx(np.array(where.places) * chain.length)
    for joint, same in zip(chain.joints, even.joints, strict=True):
        assert joint.stiffness * joint.span == pytest.approx(same.stiffness * same.span)
        assert joint.damping * joint.span == pytest.approx(same.damping * same.span)
        assert joint.upper / joint.span == pytest.approx(same.upper / same.span)
        assert joint.effort == same.effort
    heights = [link.shapes[0].solid.size[2] for link in chain.links]  # type: ignore[union-attr]
    assert heights == pytest.approx(
        [after - before for before, after in pairwise((0, *places, chain.length))]
    )
    for link in chain.links:
        _, y, z = link.shapes[0].solid.size  # type: ignore[union-attr]
        assert link.inertial.inertia[0] == pytest.approx(
            link.inertial.mass * (y * y + z * z) / 12, rel=1e-9
        )


def test_cut_anew_the_joints_stand_at_gauss_points_again() -> None:
    ten, three = (
        compiled(manipulator(actuator(10, X, joint_placement="gauss"))),
        layout("gauss", (0, 0, 0), 1),
    )
    chain = cut(ten, 3).chain
    places = np.cumsum([joint.origin[2] for joint in chain.joints])
    assert places == pytest.approx(np.array(three.places) * chain.length)
    assert cut(cut(ten, 3), 10).chain.joints[4].stiffness == pytest.approx(
        ten.chain.joints[4].stiffness
    )


def test_spheres_have_no_length_to_change() -> None:
    body = actuator(4, X, joint_placement="gauss", link_definition=SPHERE)
    (problem,) = compiler.document_problems(document_of(manipulator(body)))
    assert "spheres have no length" in problem.message
    even = actuator(4, X, joint_placement="uniform", link_definition=SPHERE)
    assert compiler.document_problems(document_of(manipulator(even))) == ()
    assert (
        compiler.document_problems(document_of(manipulator({**body, "link_definition": BOX}))) == ()
    )
