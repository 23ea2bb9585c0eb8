"""Columns kept by patterns of their names."""

from __future__ import annotations

import pytest

from somo_cli.simulation.selection import kept

NAMES = ("a.tip.x_m", "a.tip.y_m", "a.joint_01.angle_rad", "b.tip.x_m")


@pytest.mark.parametrize(
    ("patterns", "places"),
    [
        ((), (0, 1, 2, 3)),
        (("*",), (0, 1, 2, 3)),
        (("a.tip.*",), (0, 1)),
        (("*.x_m",), (0, 3)),
        (("*.[xy]_m",), (0, 1, 3)),
        (("b.*", "a.tip.?_m", "b.tip.x_m"), (0, 1, 3)),
        (("a.tip",), ()),
        (("A.*",), ()),
    ],
)
def test_what_is_kept(patterns: tuple[str, ...], places: tuple[int, ...]) -> None:
    found = kept(patterns, NAMES)
    assert found.places == places
    assert found.names == tuple(NAMES[place] for place in places)
    assert found.is_whole is (places == (0, 1, 2, 3))
