from __future__ import annotations

import math
import time

import pytest

from somo_cli.document.table import MAX_PROBLEMS, Table, read_table, require_columns, table_problems
from somo_cli.document.table_units import in_si
from somo_cli.problems import InvalidFile, Problem, Span

POINT = "are these decimal commas? write 0.5, not 0,5"
NUMBER = "write it like 0.5"
FINITE = "write an ordinary number, or leave the row out"
COMMAS = "the columns must be separated by commas, found "


def at(line: int, column: int, width: int = 1) -> Span:
    return Span("t.csv", line, column, width)


def table(text: str) -> Table:
    return read_table(text, "t.csv")


def refusal(text: str) -> list[Problem]:
    with pytest.raises(InvalidFile) as caught:
        table(text)
    assert caught.value.texts == {"t.csv": text.removeprefix("\ufeff")}
    return list(caught.value.problems)


@pytest.mark.parametrize(
    "text",
    [
        "t,x\n0,1\n0.5,-2e-3\n",
        "t,x\n0,1\n0.5,-2e-3",
        "t,x\r\n0,1\r\n0.5,-2e-3\r\n",
        "t,x\r0,1\r0.5,-2e-3\r",
        "\ufefft,x\n0,1\n0.5,-2e-3\n",
        "# made by hand\n #t,y\n\n t , x \n\n 0 ,\t1\n \n.5  , -2E-03\n\n",
        '"t","x"\n"0",1\n 0.50 , "-2.e-3" \n',
    ],
)
def test_a_table_is_its_columns(text: str) -> None:
    found = table(text)
    assert found.names == ("t", "x")
    assert found.columns == {"t": (0.0, 0.5), "x": (1.0, -0.002)}
    assert found.source == "t.csv"
    assert found.texts == {"t.csv": text.removeprefix("\ufeff")}


def test_one_column_needs_no_comma() -> None:
    assert table("x \t \n1\n").columns == {"x": (1.0,)}
    assert table("bend angle\n1\n").columns == {"bend angle": (1.0,)}


def test_every_cell_has_its_place() -> None:
    found = table('# é\n\u00e9\u00fc , "a,""b" ,c\n\n1,2,3\n 1.25 ,\t"2" ,-3 \n')
    assert found.names == ("éü", 'a,"b', "c")
    assert found.header_span("éü") == at(2, 1, 2)
    assert found.header_span('a,"b') == at(2, 6, 7)
    assert found.header_span("c") == at(2, 15)
    assert [found.cell_span(0, name) for name in found.names] == [at(4, 1), at(4, 3), at(4, 5)]
    assert [found.cell_span(1, name) for name in found.names] == [
        at(5, 2, 4),
        at(5, 9, 3),
        at(5, 14, 2),
    ]
    assert found.cell_span(-1, "c") == at(5, 14, 2)
    with pytest.raises(ValueError, match="d"):
        found.header_span("d")
    with pytest.raises(IndexError):
        found.cell_span(2, "c")


@pytest.mark.parametrize("text", ["", "\n", "\ufeff", " \r\n\n", "# nothing\n"])
def test_an_empty_file_is_a_problem(text: str) -> None:
    assert refusal(text) == [Problem(at(1, 1), "the file is empty")]


@pytest.mark.parametrize("text", [" t,x", "# c\n t,x\n\n \n"])
def test_a_header_alone_is_a_problem(text: str) -> None:
    line = 2 if "#" in text else 1
    assert refusal(text) == [Problem(at(line, 2, 3), "no row follows the header")]


@pytest.mark.parametrize(
    ("text", "column", "found"),
    [("t;x\n0,1;1\n", 2, "';'"), (" t \tx\n0\t1\n", 4, "a tab"), ("t ;\tx\n0\n", 3, "';'")],
)
def test_another_separator_is_one_problem(text: str, column: int, found: str) -> None:
    hint = "numbers have a point, as in 0.5,1.2"
    assert refusal(text) == [Problem(at(1, column), COMMAS + found, hint)]


def test_numbers_in_place_of_names_are_a_problem() -> None:
    hint = "name the columns in the first line that does not start with '#'"
    assert refusal("# t,x\n0,1\n1,2\n") == [Problem(at(2, 1, 3), "the columns have no names", hint)]


def test_a_column_needs_a_name_of_its_own() -> None:
    assert refusal('x,, "x",y,\n1,2,3,4,5\n') == [
        Problem(at(1, 3), "this column has no name", "name it, or drop the comma"),
        Problem(
            at(1, 5, 3),
            "two columns are named 'x'",
            "the first one starts in column 1 of this line",
        ),
        Problem(at(1, 11), "this column has no name", "name it, or drop the comma"),
    ]


def test_every_problem_of_every_row_is_reported() -> None:
    text = "t,x\n0,1\n 1 \n2,3,4,\n\na b, \nnan,-Infinity\n1e999,1_0\n\u0661,0x1\n# c,1\n"
    assert refusal(text) == [
        Problem(at(3, 2), "1 cell, but the header names 2 columns"),
        Problem(at(4, 1, 6), "4 cells, but the header names 2 columns"),
        Problem(at(6, 1, 3), "not a number: 'a b'", NUMBER),
        Problem(at(6, 6), "this cell is empty", "write a number"),
        Problem(at(7, 1, 3), "not a finite number: nan", FINITE),
        Problem(at(7, 5, 9), "not a finite number: -Infinity", FINITE),
        Problem(at(8, 1, 5), "not a finite number: 1e999", FINITE),
        Problem(at(8, 7, 3), "not a number: '1_0'", NUMBER),
        Problem(at(9, 1), "not a number: '\u0661'", NUMBER),
        Problem(at(9, 3, 3), "not a number: '0x1'", NUMBER),
        Problem(at(10, 1, 3), "not a number: '# c'", NUMBER),
    ]


def test_quotes_that_are_not_closed_are_no_number() -> None:
    assert refusal('x\n"1\n"1"2\n"1,"\n') == [
        Problem(at(2, 1, 2), "not a number: '\"1'", NUMBER),
        Problem(at(3, 1, 4), "not a number: '\"1\"2'", NUMBER),
        Problem(at(4, 1, 4), "not a number: '1,'", NUMBER),
    ]


def test_decimal_commas_are_guessed_when_every_row_is_too_wide() -> None:
    message = "4 cells, but the header names 2 columns"
    assert refusal("t,x\n0,0,1,5\n0,1,1,6\n") == [
        Problem(at(2, 1, 7), message, POINT),
        Problem(at(3, 1, 7), message, POINT),
    ]


def test_problems_of_header_and_rows_come_together() -> None:
    assert [problem.span for problem in refusal("x,x\n1\na,2\n")] == [
        at(1, 3),
        at(2, 1),
        at(3, 1),
    ]


@pytest.mark.parametrize("row", ["a,b\n", "1\n", "a,1\n", ",,\n"])
def test_the_number_of_reported_problems_is_limited(row: str) -> None:
    problems = refusal("x,y\n" + row * 100)
    assert len(problems) == MAX_PROBLEMS == 20
    assert len(refusal("," * 30 + "x\n" + row * 100)) == MAX_PROBLEMS


def test_a_long_cell_is_cut_short() -> None:
    (problem,) = refusal("x\n" + "a" * 70 + "\n")
    assert problem == Problem(at(2, 1, 70), f"not a number: '{'a' * 56} ...'", NUMBER)


def test_a_large_table_is_read_fast() -> None:
    text = "t,x,y,z\n" + "".join(f"{row},1.5,-2e-3,{row}.25\n" for row in range(50_000))
    blanks = "x\n" + " " * 200_000 + "1" + " " * 200_000 + "a\n" + '"' * 200_001
    start = time.process_time()
    assert sum(table(text).columns["t"]) == sum(range(50_000))
    assert len(refusal(blanks)) == 2
    assert time.process_time() - start < 10


def test_a_table_with_all_that_is_required_passes() -> None:
    found = table("t,x\n0,1\n1,1\n")
    assert table_problems(found) == []
    assert table_problems(found, ["x"], "t", 2, "a fit") == []
    require_columns(found, ["x", "t"], "t", 2, "a fit")


def test_what_is_missing_is_named_at_the_header() -> None:
    found = table("# c\n time,bend\n0,1\n")
    assert table_problems(found, ["time", "bent", "force", "bent"]) == [
        Problem(at(2, 2, 9), "there is no column 'bent'", "did you mean 'bend'?"),
        Problem(at(2, 2, 9), "there is no column 'force'", "known columns: time, bend"),
    ]
    assert table_problems(found, (), "tim") == [
        Problem(at(2, 2, 9), "there is no column 'tim'", "did you mean 'time'?")
    ]


@pytest.mark.parametrize(
    ("times", "row", "width", "found"),
    [
        ([0, 1, 1, 2], 2, 1, "1.0 after 1.0"),
        ([0, 2, 1.25, 1.5], 2, 4, "1.25 after 2.0"),
        ([0, -1, -1, -3], 1, 2, "-1.0 after 0.0, and so in 2 more rows"),
        ([0, -1, 1, 0], 1, 2, "-1.0 after 0.0, and so in 1 more row"),
    ],
)
def test_a_column_that_does_not_rise_is_named_once(
    times: list[float], row: int, width: int, found: str
) -> None:
    text = "x,t\n" + "".join(f"0, {time}\n" for time in times)
    message = f"'t' must increase, found {found}"
    hint = "each 't' must be greater than the one above it"
    assert table_problems(table(text), (), "t") == [Problem(at(row + 2, 4, width), message, hint)]


def test_all_that_is_not_as_required_is_raised_together() -> None:
    found = table("t,x\n1,1\n0,2\n")
    with pytest.raises(InvalidFile) as caught:
        require_columns(found, ["y"], "t", 3, "a fit of 2 parameters")
    assert caught.value.texts == found.texts
    assert [problem.message for problem in caught.value.problems] == [
        "there is no column 'y'",
        "2 rows, but a fit of 2 parameters needs at least 3",
        "'t' must increase, found 0.0 after 1.0",
    ]
    assert table_problems(table("t\n1\n"), (), None, 2, "a fit") == [
        Problem(at(1, 1), "1 row, but a fit needs at least 2")
    ]


def test_units_of_labs_are_converted() -> None:
    text = "time_ms,pressure_kpa,tip.x_mm,bend_deg,force_mn,force_n\n10,20,1.5,90,2,3\n"
    table, done = in_si(read_table(text, "lab.csv"))
    assert table.names == ("time_s", "pressure_pa", "tip.x_m", "bend_rad", "force_mn", "force_n")
    (row,) = zip(*table.columns.values(), strict=True)
    found = dict(zip(table.columns, row, strict=True))
    assert found == pytest.approx(
        {
            "time_s": 0.01,
            "pressure_pa": 2e4,
            "tip.x_m": 1.5e-3,
            "bend_rad": math.pi / 2,
            "force_mn": 2,  # there is a force_n as well
            "force_n": 3,
        }
    )
    assert done[1] == "pressure_kpa is taken as pressure_pa, times 1000"
    assert table.header_span("pressure_pa").column == 9
    assert in_si(table) == (table, [])
