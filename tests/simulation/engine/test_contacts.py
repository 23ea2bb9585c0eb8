"""Sums of contact points: from either side, by pair and by link, with their friction."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.contacts import NONE, Place, Touch


def touch(first: Place, second: Place, seed: int) -> Touch:
    """Return a contact point of random forces; friction stands across the normal."""
    random = np.random.default_rng(seed)
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    normal, one, other = (tuple(axis) for axis in axes.T.tolist())
    pressed, *rubbed = random.uniform(0.1, 2, 3)
    return Touch(
        first, second, (0.0, 0.0, 0.0), normal, pressed, ((one, -rubbed[0]), (other, rubbed[1]))
    )


TOUCHES = [
    touch((0, 3), (1, 0), 0),
    touch((0, 2), (1, 0), 1),
    touch((2, 0), (0, 3), 2),
    touch((1, 0), (2, 0), 3),
    touch((0, 1), (0, 3), 4),  # the first body touches itself
]


def test_action_is_reaction() -> None:
    on_body = [np.array(contacts.total(contacts.on(TOUCHES, body))[:3]) for body in range(3)]
    assert sum(on_body) == pytest.approx([0, 0, 0], abs=1e-15)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        there, back = (contacts.load(contacts.between(TOUCHES, *pair)) for pair in ((a, b), (b, a)))
        assert there.normal == back.normal > 0
        assert there.friction == pytest.approx(back.friction)
        for name in ("fx", "fy", "fz", "friction_x", "friction_y", "friction_z"):
            assert getattr(there, name) == pytest.approx(-getattr(back, name), abs=1e-15)


@pytest.mark.parametrize("body", [0, 1, 2])
def test_pairs_and_links_sum_up_to_the_whole(body: int) -> None:
    whole = contacts.total(contacts.on(TOUCHES, body))
    by_pair = [
        contacts.load(contacts.between(TOUCHES, body, other)) for other in range(3) if other != body
    ]
    by_link = [contacts.load(contacts.on_link(TOUCHES, (body, link))) for link in range(4)]
    assert np.sum(by_pair, axis=0)[:4] == pytest.approx(whole, abs=1e-14)
    assert np.sum(by_link, axis=0)[:3] == pytest.approx(whole[:3], abs=1e-14)


def test_a_force_within_a_body_is_on_its_links_and_not_on_the_whole() -> None:
    own = TOUCHES[4:]
    assert contacts.on(own, 0) == []
    one, other = (np.array(contacts.load(contacts.on_link(own, (0, link)))) for link in (1, 3))
    assert one[:3] == pytest.approx(-other[:3])
    assert one[3] == other[3] == own[0].pressed


def test_friction_is_what_is_across_the_normal() -> None:
    point = TOUCHES[0]
    load = contacts.load(contacts.on([point], 0))
    force, friction = np.array(load[:3]), np.array(load[5:])
    assert force - friction == pytest.approx(point.pressed * np.array(point.normal))
    assert friction @ np.array(point.normal) == pytest.approx(0, abs=1e-15)
    assert load.friction == pytest.approx(np.linalg.norm(friction))
    assert load.normal == point.pressed


def test_nothing_is_nothing() -> None:
    assert contacts.load([]) == NONE
    assert contacts.total([]) == (0, 0, 0, 0)
