"""What the recorder writes, and when."""

from __future__ import annotations

import io
import math
import sys

import numpy as np

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
    recorder = CsvRecorder(stream, ["time_s", "a.x_m"])
    assert recorder.rows == 0
    recorder.write([0.0, 1])
    recorder.write(iter([0.1, -2.5e-9]))
    assert recorder.rows == 2
    assert stream.getvalue() == "time_s,a.x_m\n0.0,1.0\n0.1,-2.5e-09\n"


def test_numbers_read_back_as_the_same_floats() -> None:
    values = [
        0.1, 1 / 3, math.pi * 1e-300, 5e-324, sys.float_info.max, -0.0, 1e16, 123456789.123456789,
        *np.random.default_rng(1).normal(size=500),
    ]  # fmt: skip
    stream = io.StringIO()
    CsvRecorder(stream, []).write(values)
    cells = stream.getvalue().splitlines()[1].split(",")
    assert [float(cell).hex() for cell in cells] == [float(value).hex() for value in values]
    assert not any(cell.startswith("np") for cell in cells)


def test_every_write_is_a_whole_line() -> None:
    pipe = Pipe()
    recorder = CsvRecorder(pipe, ["a", "b"])
    recorder.write([1.0, 2.0])
    assert pipe.written == ["a,b\n", "1.0,2.0\n"]
    assert pipe.flushed == []


def test_a_reader_gets_every_row_at_once() -> None:
    pipe = Pipe()
    recorder = CsvRecorder(pipe, ["a"], flush_rows=True)
    recorder.write([1.0])
    recorder.write([2.0])
    assert pipe.flushed == ["a\n", "a\n1.0\n", "a\n1.0\n2.0\n"]
