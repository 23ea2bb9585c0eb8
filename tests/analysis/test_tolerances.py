"""What error is allowed of which column."""

from __future__ import annotations

import dataclasses
import math
import re

import pytest

from somo_cli.analysis.error_estimate import ColumnError
from somo_cli.analysis.observed_order import ObservedOrder
from somo_cli.analysis.tolerances import read_tolerances

NAMES = ("finger.tip.x_m", "cube.pose.x_m", "cube.pose.qx")
ERROR = ColumnError(
    name="cube.pose.x_m",
    unit="m",
    measure="largest",
    final=0.0,
    maximum=0.0,
    rms=0.0,
    judged=2e-3,
    scale=0.1,
    order=ObservedOrder(2.0, 2),
)
TIP = dataclasses.replace(ERROR, name="finger.tip.x_m")


def test_a_share_is_of_the_scale_and_a_value_in_the_unit_of_the_column() -> None:
    found = read_tolerances(["0.04", "cube.*=4e-3", "cube.pose.x_m=1e-3"], NAMES)
    assert found.excess(TIP) == pytest.approx(0.5)  # 2 % of 4 %
    assert found.excess(ERROR) == pytest.approx(2)  # the last pattern that matches
    assert found.excess(dataclasses.replace(ERROR, name="cube.pose.qx")) == pytest.approx(0.5)
    assert found.plain_data() == {
        "relative": 0.04,
        "columns": {"cube.*": 4e-3, "cube.pose.x_m": 1e-3},
    }


def test_without_a_share_only_what_matches_is_judged() -> None:
    found = read_tolerances(["cube.pose.?_m=1e-3"], NAMES)
    assert found.excess(ERROR) == pytest.approx(2)
    assert found.excess(TIP) == 0
    assert not math.isnan(found.excess(TIP))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a", "'a' is neither a number nor COLUMN=NUMBER, such as 'cube.pose.*=1e-4'"),
        ("cube.*=b", "'cube.*=b' is neither a number nor COLUMN=NUMBER, such as"),
        ("0", "0 is not greater than 0"),
        ("nan", "nan is not greater than 0"),
        ("cube.*=-1", "-1 is not greater than 0"),
        ("1", "1 is not below 1: it is a share of the range of a column"),
        ("cube.pos.x_m=1", "no column matches 'cube.pos.x_m'; did you mean 'cube.pose.x_m'?"),
    ],
)
def test_what_is_no_tolerance_is_refused(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        read_tolerances([text], NAMES)
