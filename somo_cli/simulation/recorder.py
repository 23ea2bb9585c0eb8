"""Rows to CSV as they come; never holds more than one row."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TextIO


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
