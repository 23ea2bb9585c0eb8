"""A study: a scene, parameters that vary, how they are combined, and what is taken of each run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from somo_cli.problems import Pointer
from somo_cli.scene.column_units import unit_of
from somo_cli.scene.duration import steps_of
from somo_cli.scene.pose_table import TIME
from somo_cli.sweep.expressions import Expression
from somo_cli.sweep.reductions import Options

Spacing: TypeAlias = Literal["values", "linear", "log", "random", "expression"]
Combination: TypeAlias = Literal[
    "grid", "zip", "slices", "random", "latin_hypercube", "sobol", "table"
]
SAMPLED: tuple[Combination, ...] = ("random", "latin_hypercube", "sobol")
"""Combinations that draw `count` sets."""
Point: TypeAlias = Mapping[str, Any]
"""The values of all parameters of a run, by name."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter: the values that it takes, or an expression over others, and what it sets.

    `values` is empty for a random parameter, which lies between `bounds`, for an expression, and
    where a table has the values. `targets` are pointers into the scene with its files included.
    """

    name: str
    targets: tuple[Pointer, ...]
    spacing: Spacing
    values: tuple[Any, ...] = ()
    bounds: tuple[float, float] | None = None
    is_log: bool = False
    expression: Expression | None = None


@dataclass(frozen=True, slots=True)
class Label:
    """A label: what is taken of a column, a whole column, or an expression over labels.

    A label that is a whole column (`take` None) is for expressions, and has no place in the table.
    """

    name: str
    column: str | None = None
    take: str | None = None
    after: float | None = None
    before: float | None = None
    options: Options = field(default_factory=Options)
    expression: Expression | None = None

    @property
    def is_series(self) -> bool:
        """Whether the label is a whole column."""
        return self.column is not None and self.take is None

    @property
    def unit(self) -> str | None:
        """The unit of the value, if it is that of the column."""
        has_unit = self.take in ("first", "last", "min", "max", "mean", "std", "median", "range")
        if self.column is None or not (has_unit or self.take in ("at", "per_cycle")):
            return None
        return unit_of(self.column) or None


def error_name(label: str) -> str:
    """Return the name of the column with the error of a label."""
    return f"{label}_error"


@dataclass(frozen=True, slots=True)
class Study:
    """A study that was read and has no errors.

    `steps` or `duration` [s] is given; `time_out` [s] of one run, None without one.
    """

    scene: str
    parameters: tuple[Parameter, ...]
    labels: tuple[Label, ...]
    points: tuple[Point, ...]
    combination: Combination
    steps: int | None
    duration: float | None
    time_out: float | None
    keep: bool | Expression
    has_errors: bool = False
    """Whether each run is done at half the step as well, for an estimate of its error."""

    def steps_at(self, time_step: float) -> int:
        """Return the number of steps of a run with a time step [s], the nearest whole one."""
        return self.steps if self.steps is not None else steps_of(self.duration or 0.0, time_step)

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns that labels need beside the time, each once."""
        named = (one.column for one in self.labels if one.column is not None)
        return tuple(dict.fromkeys(column for column in named if column != TIME))

    @property
    def header(self) -> tuple[str, ...]:
        """The columns of the table of results."""
        labels = (one.name for one in self.labels if not one.is_series)
        return ("run", *(one.name for one in self.parameters), *labels, *self.errors, *OUTCOME)

    @property
    def errors(self) -> tuple[str, ...]:
        """The columns of errors, one for each label of the table."""
        if not self.has_errors:
            return ()
        return tuple(error_name(one.name) for one in self.labels if not one.is_series)


OUTCOME = ("status", "findings", "reason", "run_time_s")
"""The columns of the table that tell how a run ended."""
