"""Columns selected by patterns of their names."""

from __future__ import annotations

import pytest

from somo_cli.scene.column_selection import select_columns

NAMES = ("a.tip.x_m", "a.tip.y_m", "a.joint_01.angle_rad", "b.tip.x_m")


@pytest.mark.parametrize(
    ("patterns", "indices"),
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
def test_what_is_kept(patterns: tuple[str, ...], indices: tuple[int, ...]) -> None:
    found = select_columns(patterns, NAMES)
    assert found.indices == indices
    assert found.names == tuple(NAMES[index] for index in indices)
    assert found.selects_all is (indices == (0, 1, 2, 3))
