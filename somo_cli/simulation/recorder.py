"""Rows to CSV as they come, and rows kept to be read again; only a few at a time in memory."""

from __future__ import annotations

import struct
from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from types import TracebackType
from typing import BinaryIO, TextIO

import numpy as np

from somo_cli.simulation import decimals

_NUMBERS = 4096  # that are turned into decimals at once, which is when that is fastest
_ROWS = 256  # at most, however narrow


class CsvRecorder:
    """Writes a header and then rows to an open text stream.

    Numbers are the shortest decimals that read back as exactly the same floats. Names come from
    a safe alphabet, so nothing needs quotes. Rows are written several at once, the last ones on
    leaving the context, whatever ends it. With `flush_rows` every row leaves as a whole line at
    once, for a reader at the other end of a pipe.
    """

    def __init__(self, stream: TextIO, names: Sequence[str], flush_rows: bool = False) -> None:
        self._stream = stream
        self.rows = 0
        self._width = len(names)
        row = struct.Struct(f"{self._width}d")
        self._row_size, self._pack_into = row.size, row.pack_into
        most = max(1, min(_ROWS, _NUMBERS // max(1, self._width)))
        self._waiting = bytearray(most * row.size)
        self._end = 0  # of what waits
        self.write: Callable[[Iterable[float]], None] = self._keep
        """Writes one row."""
        stream.write(",".join(names) + "\n")
        if flush_rows:
            self.write = self._pass_on
            stream.flush()

    def __enter__(self) -> CsvRecorder:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            self._empty()
        except OSError:
            if kind is None:  # a full disk is not to hide what ended the context
                raise

    def _keep(self, values: Iterable[float]) -> None:
        self._pack_into(self._waiting, self._end, *values)
        self._end += self._row_size
        self.rows += 1
        if self._end == len(self._waiting):
            self._empty()

    def _empty(self) -> None:
        flat = np.frombuffer(self._waiting, dtype=np.float64, count=self._end // 8)
        text = decimals.lines(flat.reshape(-1, self._width)).decode() if self._end else ""
        self._end = 0  # before it is written, so that nothing is written twice
        self._stream.write(text)

    def _pass_on(self, values: Iterable[float]) -> None:
        self._stream.write(",".join(map(repr, map(float, values))) + "\n")
        self._stream.flush()
        self.rows += 1


class RowSpool:
    """Keeps rows of so many numbers in a binary stream, from which they are read again."""

    def __init__(self, stream: BinaryIO, width: int) -> None:
        self._stream = stream
        self._width = width

    def onward_to(
        self, write: Callable[[Iterable[float]], None]
    ) -> Callable[[Iterable[float]], None]:
        """Return a function that keeps a row and passes it on."""

        def keep(values: Iterable[float]) -> None:
            row = array("d", values)
            self._stream.write(row.tobytes())
            write(row)

        return keep

    def rows(self) -> Iterator[Sequence[float]]:
        """Yield every row kept, from the first."""
        self._stream.seek(0)
        size = self._width * array("d").itemsize
        while content := self._stream.read(size):
            yield array("d", content)
