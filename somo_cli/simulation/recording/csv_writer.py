"""Write rows to CSV as they come, and keep rows to be read again, a few at a time in memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import BinaryIO, TextIO

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.recording import shortest_float

_NUMBERS_PER_BLOCK = 4096  # numbers converted at once, the fastest block
_FEW_NUMBERS = 256  # up to here, one at a time is faster


class CsvWriter:
    """Writes a header and then rows to an open text stream.

    Numbers are the shortest decimals that read back as exactly the same floats. Names come from
    a safe alphabet, so nothing needs quotes. If `is_live` every row is flushed
    as a whole line, for a reader at the other end of a pipe.
    """

    def __init__(self, stream: TextIO, names: Sequence[str], is_live: bool = False) -> None:
        self._stream = stream
        self._is_live = is_live
        self._rows_at_once = max(1, _NUMBERS_PER_BLOCK // len(names))
        stream.write(",".join(names) + "\n")
        if is_live:
            stream.flush()

    def write(self, rows: Array) -> None:
        """Write rows, shape (rows, columns)."""
        for first in range(0, len(rows), self._rows_at_once):
            some = rows[first : first + self._rows_at_once]
            self._stream.write(
                _small_block_text(some) if some.size <= _FEW_NUMBERS else _block_text(some)
            )
        if self._is_live:
            self._stream.flush()


def _block_text(rows: Array) -> str:
    return shortest_float.lines(rows).decode()


def _small_block_text(rows: Array) -> str:
    return "".join(",".join(map(repr, row)) + "\n" for row in rows.tolist())


class RowSpool:
    """Keeps rows of so many numbers in a binary stream, from which they are read again."""

    def __init__(self, stream: BinaryIO, width: int) -> None:
        self._stream = stream
        self._width = width

    def write_through(self, write: Callable[[Array], None]) -> Callable[[Array], None]:
        """Return a function that keeps rows, shape (rows, columns), and passes them on."""

        def keep(rows: Array) -> None:
            self._stream.write(rows.tobytes())
            write(rows)

        return keep

    def reader(self) -> Callable[[int], Array]:
        """Return a function that gives so many of the rows kept, each time the next ones."""
        self._stream.seek(0)
        size = self._width * np.dtype(np.float64).itemsize

        def read(rows: int) -> Array:
            return np.frombuffer(self._stream.read(rows * size)).reshape(-1, self._width)

        return read
