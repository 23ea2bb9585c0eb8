from __future__ import annotations

from somo_cli.analysis.text_table import table_lines


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
