"""What the recorder writes, and when."""

from __future__ import annotations

import io
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from somo_cli.simulation.recording.csv_writer import CsvWriter, RowSpool


class Pipe(io.StringIO):
    """A stream that remembers what had been written at every flush and write."""

    def __init__(self) -> None:
        super().__init__()
        self.flushed: list[str] = []
        self.written: list[str] = []

    def flush(self) -> None:
        self.flushed.append(self.getvalue())

    def write(self, text: str) -> int:
        self.written.append(text)
        return super().write(text)


def test_a_header_and_rows() -> None:
    stream = io.StringIO()
    recorder = CsvWriter(stream, ["time_s", "a.x_m"])
    recorder.write(np.array([[0.0, 1.0]]))
    recorder.write(np.array([[0.1, -2.5e-9]]))
    assert stream.getvalue() == "time_s,a.x_m\n0.0,1.0\n0.1,-2.5e-09\n"


@pytest.mark.parametrize("rows", [1, 9])
def test_numbers_read_back_as_the_same_floats(rows: int) -> None:
    values = [
        0.1, 1 / 3, math.pi * 1e-300, 5e-324, sys.float_info.max, -0.0, 1e16, 123456789.123456789,
        *np.random.default_rng(1).normal(size=500),
    ]  # fmt: skip
    stream = io.StringIO()
    CsvWriter(stream, ["a"] * len(values)).write(np.array([values] * rows))
    cells = stream.getvalue().splitlines()[-1].split(",")
    assert [float(cell).hex() for cell in cells] == [float(value).hex() for value in values]
    assert cells == [repr(float(value)) for value in values]


@pytest.mark.parametrize("width", [1, 3, 64, 5000])
def test_rows_are_the_same_however_many_are_written_at_once(width: int) -> None:
    rows = np.random.default_rng(2).normal(size=(600 if width < 100 else 3, width))
    texts = []
    for at_once in (1, len(rows)):
        stream = io.StringIO()
        recorder = CsvWriter(stream, ["a"] * width)
        for first in range(0, len(rows), at_once):
            recorder.write(rows[first : first + at_once])
        texts.append(stream.getvalue())
    assert texts[0] == texts[1]
    assert texts[0].count("\n") == len(rows) + 1


@pytest.mark.parametrize("is_live", [True, False])
def test_every_write_is_of_whole_lines_and_a_reader_has_them_at_once(is_live: bool) -> None:
    pipe = Pipe()
    recorder = CsvWriter(pipe, ["a", "b"], is_live)
    recorder.write(np.ones((5000, 2)))
    recorder.write(np.ones((1, 2)))
    lines = "1.0,1.0\n"
    assert pipe.written == ["a,b\n", 2048 * lines, 2048 * lines, 904 * lines, lines]
    assert len(pipe.flushed) == (3 if is_live else 0)
    if is_live:
        assert pipe.flushed[-1] == pipe.getvalue()


def test_no_rows_are_no_lines() -> None:
    stream = io.StringIO()
    CsvWriter(stream, ["a"]).write(np.ones((0, 1)))
    assert stream.getvalue() == "a\n"


def test_a_spool_gives_back_what_it_took(tmp_path: Path) -> None:
    passed: list[list[float]] = []
    rows = [[0.1, 1e300], [-0.0, 2**-1074], [3.0, 4.0]]
    with (tmp_path / "rows").open("w+b") as stream:
        spool = RowSpool(stream, 2)
        keep = spool.write_through(lambda block: passed.extend(block.tolist()))
        # as `Rows` has them: columns behind each other
        keep(np.array(rows[:2]).T.copy().T)
        keep(np.array(rows[2:]))
        for _ in range(2):
            read = spool.reader()
            assert [*read(1).tolist(), *read(2).tolist()] == rows == passed
