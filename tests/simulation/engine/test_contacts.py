"""Sums of contact points: from either side, by pair and by link, with their friction."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.contacts import NO_CONTACT, ContactPoint, LinkIndex


def touch(first: LinkIndex, second: LinkIndex, seed: int) -> ContactPoint:
    """Return a contact point of random forces; friction stands across the normal."""
    random = np.random.default_rng(seed)
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    normal, one, other = (tuple(axis) for axis in axes.T.tolist())
    normal_force, *rubbed = random.uniform(0.1, 2, 3)
    return ContactPoint(
        first,
        second,
        (0.0, 0.0, 0.0),
        normal,
        normal_force,
        ((one, -rubbed[0]), (other, rubbed[1])),
    )


TOUCHES = [
    touch((0, 3), (1, 0), 0),
    touch((0, 2), (1, 0), 1),
    touch((2, 0), (0, 3), 2),
    touch((1, 0), (2, 0), 3),
    touch((0, 1), (0, 3), 4),  # the first body touches itself
]


def test_action_is_reaction() -> None:
    on_body = [
        np.array(contacts.total_force(contacts.contacts_on(TOUCHES, body))[:3]) for body in range(3)
    ]
    assert sum(on_body) == pytest.approx([0, 0, 0], abs=1e-15)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        there, back = (
            contacts.contact_force(contacts.contacts_between(TOUCHES, *pair))
            for pair in ((a, b), (b, a))
        )
        assert there.normal == back.normal > 0
        assert there.friction == pytest.approx(back.friction)
        for name in ("fx", "fy", "fz", "friction_x", "friction_y", "friction_z"):
            assert getattr(there, name) == pytest.approx(-getattr(back, name), abs=1e-15)


@pytest.mark.parametrize("body", [0, 1, 2])
def test_pairs_and_links_sum_up_to_the_whole(body: int) -> None:
    whole = contacts.total_force(contacts.contacts_on(TOUCHES, body))
    by_pair = [
        contacts.contact_force(contacts.contacts_between(TOUCHES, body, other))
        for other in range(3)
        if other != body
    ]
    by_link = [
        contacts.contact_force(contacts.contacts_on_link(TOUCHES, (body, link)))
        for link in range(4)
    ]
    assert np.sum(by_pair, axis=0)[:4] == pytest.approx(whole, abs=1e-14)
    assert np.sum(by_link, axis=0)[:3] == pytest.approx(whole[:3], abs=1e-14)


def test_a_force_within_a_body_is_on_its_links_and_not_on_the_whole() -> None:
    own = TOUCHES[4:]
    assert contacts.contacts_on(own, 0) == []
    one, other = (
        np.array(contacts.contact_force(contacts.contacts_on_link(own, (0, link))))
        for link in (1, 3)
    )
    assert one[:3] == pytest.approx(-other[:3])
    assert one[3] == other[3] == own[0].normal_force


def test_friction_is_what_is_across_the_normal() -> None:
    point = TOUCHES[0]
    load = contacts.contact_force(contacts.contacts_on([point], 0))
    force, friction = np.array(load[:3]), np.array(load[5:])
    assert force - friction == pytest.approx(point.normal_force * np.array(point.normal))
    assert friction @ np.array(point.normal) == pytest.approx(0, abs=1e-15)
    assert load.friction == pytest.approx(np.linalg.norm(friction))
    assert load.normal == point.normal_force


def test_nothing_is_nothing() -> None:
    assert contacts.contact_force([]) == NO_CONTACT
    assert contacts.total_force([]) == (0, 0, 0, 0)
