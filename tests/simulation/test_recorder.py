"""What the recorder writes, and when."""

from __future__ import annotations

import errno
import io
import math
import sys

import numpy as np
import pytest

from somo_cli.simulation.recorder import CsvRecorder


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
    with CsvRecorder(stream, ["time_s", "a.x_m"]) as recorder:
        assert recorder.rows == 0
        recorder.write([0.0, 1])
        recorder.write(iter([0.1, -2.5e-9]))
        assert recorder.rows == 2
    assert stream.getvalue() == "time_s,a.x_m\n0.0,1.0\n0.1,-2.5e-09\n"


@pytest.mark.parametrize("flush_rows", [True, False])
def test_numbers_read_back_as_the_same_floats(flush_rows: bool) -> None:
    values = [
        0.1, 1 / 3, math.pi * 1e-300, 5e-324, sys.float_info.max, -0.0, 1e16, 123456789.123456789,
        *np.random.default_rng(1).normal(size=500),
    ]  # fmt: skip
    stream = io.StringIO()
    with CsvRecorder(stream, ["a"] * len(values), flush_rows) as recorder:
        recorder.write(values)
    cells = stream.getvalue().splitlines()[1].split(",")
    assert [float(cell).hex() for cell in cells] == [float(value).hex() for value in values]
    assert cells == [repr(float(value)) for value in values]


@pytest.mark.parametrize("width", [1, 3, 64, 5000])
def test_rows_are_the_same_however_many_are_written_at_once(width: int) -> None:
    rows = np.random.default_rng(2).normal(size=(600 if width < 100 else 3, width)).tolist()
    texts = []
    for flush_rows in (True, False):
        stream = io.StringIO()
        with CsvRecorder(stream, ["a"] * width, flush_rows) as recorder:
            for row in rows:
                recorder.write(row)
        texts.append(stream.getvalue())
    assert texts[0] == texts[1]
    assert texts[0].count("\n") == len(rows) + 1


def test_every_write_is_of_whole_lines_and_nothing_waits_for_long() -> None:
    pipe = Pipe()
    with CsvRecorder(pipe, ["a", "b"]) as recorder:
        for _ in range(600):
            recorder.write([1.0, 2.0])
    lines = "1.0,2.0\n"
    assert pipe.written == ["a,b\n", 256 * lines, 256 * lines, 88 * lines]
    assert pipe.flushed == []


def write_and_end(stream: io.StringIO, end: Exception | None) -> None:
    with CsvRecorder(stream, ["a"]) as recorder:
        recorder.write([0.5])
        if end is not None:
            raise end


def test_what_waits_is_written_whatever_ends_the_run() -> None:
    stream = io.StringIO()
    with pytest.raises(EOFError):
        write_and_end(stream, EOFError())
    assert stream.getvalue() == "a\n0.5\n"


class Full(io.StringIO):
    """A disk with room for the header alone."""

    def write(self, text: str) -> int:
        if self.getvalue():
            raise OSError(errno.ENOSPC, "no space left")
        return super().write(text)


@pytest.mark.parametrize(("end", "told"), [(None, OSError), (EOFError(), EOFError)])
def test_a_full_disk_is_told_but_hides_no_other_end(
    end: Exception | None, told: type[Exception]
) -> None:
    with pytest.raises(told):
        write_and_end(Full(), end)


def test_a_reader_gets_every_row_at_once() -> None:
    pipe = Pipe()
    recorder = CsvRecorder(pipe, ["a"], flush_rows=True)
    recorder.write([1.0])
    recorder.write([2.0])
    assert pipe.flushed == ["a\n", "a\n1.0\n", "a\n1.0\n2.0\n"]
