from __future__ import annotations

from somo_cli.analysis.text_table import table_lines, without_rounding


def test_columns_are_as_wide_as_their_widest_cell() -> None:
    assert table_lines([["name", "a", "long one"], ["x", "123", "4"]]) == [
        "name    a  long one",
        "x     123         4",
    ]


def test_short_and_empty_rows() -> None:
    assert table_lines([["a", "b", "c"], ["diverged"], [], ["a", "bcd"]]) == [
        "a           b  c",
        "diverged",
        "",
        "a         bcd",
    ]
    assert table_lines([]) == []


def test_zero_has_no_sign() -> None:
    rows = [["a", "-0 %", "+0.00 %", "-0.0", "-0e+00", "-0.01", "-0x", "+0.1 %", "-", "-0-"]]
    shown = ["a", "0 %", "0.00 %", "0.0", "0e+00", "-0.01", "-0x", "+0.1 %", "-", "-0-"]
    assert table_lines(rows) == ["  ".join(shown)]


def test_rounding_is_shown_as_zero() -> None:
    assert without_rounding(-8.7e-17, 0.02) == 0
    assert without_rounding(-8.7e-15, 0.02) == -8.7e-15
    assert without_rounding(0.0, 0.0) == 0
