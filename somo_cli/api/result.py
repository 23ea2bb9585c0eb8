"""The result of `simulate`: columns by name, metadata, and the CSV of `somo run`."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any

from somo_cli import output_files
from somo_cli.arrays import Array
from somo_cli.problems import with_unit_of
from somo_cli.simulation.recording.csv_writer import CsvWriter


@dataclass(frozen=True, slots=True)
class Result:
    """The recorded columns of a run, in SI units; each name ends with its unit.

    `values` has shape (rows, columns); column 0 is the time. `metadata` is what `somo run` writes
    beside its CSV.
    """

    names: tuple[str, ...]
    values: Array
    metadata: Mapping[str, Any]

    @property
    def time(self) -> Array:
        """The time of every row [s], shape (rows,)."""
        return self.values[:, 0]

    def __getitem__(self, name: str) -> Array:
        """Return one column, shape (rows,). Raises KeyError, with the closest names."""
        if name not in self.names:
            from difflib import get_close_matches

            close = get_close_matches(name, with_unit_of(name, self.names), 3)
            hint = f"; did you mean {' or '.join(close)}?" if close else ""
            raise KeyError(f"no column is called {name!r}{hint}")
        return self.values[:, self.names.index(name)]

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.values)

    def to_csv(self, path: str | PathLike[str] | None = None) -> str:
        """Return the CSV text that `somo run` writes, byte for byte; write it to `path` if given.

        The file is replaced as a whole or not at all. Raises OSError.
        """
        stream = io.StringIO()
        CsvWriter(stream, self.names).write(self.values)
        text = stream.getvalue()
        if path is not None:
            output_files.write_atomically(fspath(path), text)
        return text

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame with a column for each name.

        Raises ImportError without pandas, which is not installed with somo.
        """
        from importlib import import_module

        pandas = import_module("pandas")
        return pandas.DataFrame(self.values, columns=list(self.names))
