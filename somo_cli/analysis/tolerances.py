"""What error is allowed of each column: a share of its scale, or a value in its unit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from somo_cli.analysis.error_estimate import ColumnError
from somo_cli.problems import did_you_mean
from somo_cli.scene.column_selection import select_columns


@dataclass(frozen=True, slots=True)
class Tolerances:
    """A share of the scale for all columns, and values for columns whose name matches a pattern.

    The last pattern that matches decides. Without a share, columns that no pattern matches are not
    judged.
    """

    share: float | None
    by_pattern: tuple[tuple[str, float], ...] = ()

    def excess(self, error: ColumnError) -> float:
        """Return an error over the one allowed; at most 1 is fine, and 0 is what is not judged."""
        for pattern, value in reversed(self.by_pattern):
            if select_columns((pattern,), (error.name,)).indices:
                return error.judged / value
        return 0.0 if self.share is None else error.relative / self.share

    def judges(self, error: ColumnError) -> bool:
        """Whether there is a tolerance for the column of an error."""
        return self.share is not None or any(
            select_columns((pattern,), (error.name,)).indices for pattern, _ in self.by_pattern
        )

    def are_met(self, errors: Sequence[ColumnError]) -> bool:
        """Whether there are errors, and each is within its tolerance."""
        return bool(errors) and all(self.excess(error) <= 1 for error in errors)

    def plain_data(self) -> dict[str, object]:
        """Return the same as values for JSON."""
        return {"relative": self.share, "columns": dict(self.by_pattern)}


def read_tolerances(texts: Sequence[str], names: Sequence[str]) -> Tolerances:
    """Return the tolerances of texts such as "1e-2" and "cube.pose.*=1e-4".

    Raises ValueError for what is neither, and for a pattern that matches none of the names.
    """
    share, patterns = None, {}
    for text in texts:
        pattern, is_value, value = text.rpartition("=")
        if is_value:
            patterns[pattern] = _positive(value, text)
        else:
            share = _positive(value, text)
    return tolerances(share, patterns, names)


def tolerances(
    share: float | None, patterns: Mapping[str, float], names: Sequence[str]
) -> Tolerances:
    """Return tolerances for columns of these names.

    Raises ValueError for numbers that are no tolerance, and for a pattern that matches none.
    """
    for value in (*(() if share is None else (share,)), *patterns.values()):
        if not (value > 0 and math.isfinite(value)):
            raise ValueError(f"{value:g} is not greater than 0")
    if share is not None and share >= 1:
        raise ValueError(f"{share:g} is not below 1: it is a share of the range of a column")
    for pattern in patterns:
        if not select_columns((pattern,), names).indices:
            hint = did_you_mean(pattern, names)
            raise ValueError(f"no column matches {pattern!r}" + (f"; {hint}" if hint else ""))
    return Tolerances(share, tuple(patterns.items()))


def _positive(value: str, text: str) -> float:
    try:
        return float(value)
    except ValueError:
        message = f"{text!r} is neither a number nor COLUMN=NUMBER, such as 'cube.pose.*=1e-4'"
        raise ValueError(message) from None
