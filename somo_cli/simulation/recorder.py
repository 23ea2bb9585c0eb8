"""Rows to CSV as they come, and rows kept to be read again; never more than one in memory."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import BinaryIO, TextIO


class CsvRecorder:
    """Writes a header and then rows to an open text stream.

    Numbers are the shortest decimals that read back as exactly the same floats. Names come from
    a safe alphabet, so nothing needs quotes. With `flush_rows` every row leaves as a whole line
    at once, for a reader at the other end of a pipe.
    """

    def __init__(self, stream: TextIO, names: Sequence[str], flush_rows: bool = False) -> None:
        self._stream = stream
        self._flush_rows = flush_rows
        self.rows = 0
        self._write_line(names)

    def write(self, values: Iterable[float]) -> None:
        """Write one row."""
        self._write_line(map(repr, map(float, values)))
        self.rows += 1

    def _write_line(self, cells: Iterable[str]) -> None:
        self._stream.write(",".join(cells) + "\n")
        if self._flush_rows:
            self._stream.flush()


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
