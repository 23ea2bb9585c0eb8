"""A measured motion, as columns that a run of a scene records."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.document.table import Table, require_columns
from somo_cli.problems import InvalidFile, Problem
from somo_cli.scene import columns
from somo_cli.scene.model import Quantity, Scene
from somo_cli.simulation.plan.build import make_plan

TIME = "time_s"
MEASURABLE: tuple[Quantity, ...] = (
    "joint_angles",
    "joint_rates",
    "tip_position",
    "curvatures",
    "bending_angles",
    "link_positions",
    "link_orientations",
    "base_pose",
)
"""What a camera, an encoder or a strain gauge can measure, under the names of `somo run`."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """Measured columns over time.

    `times` [s], shape (rows,), are from the start of the scene; `values`, shape (rows, columns),
    are in SI. `places` are the positions of the columns in a row of a run that records
    `quantities`; `owners` are the indices of the quantities that the columns belong to.
    """

    names: tuple[str, ...]
    times: Array
    values: Array
    quantities: tuple[Quantity, ...]
    places: tuple[int, ...]
    owners: tuple[int, ...]

    @property
    def scatter(self) -> Array:
        """Standard deviation of each column, shape (columns,)."""
        scatter: Array = self.values.std(axis=0)
        return scatter

    def weights(self, residuals: Array) -> Array:
        """Return each column's weight, 1 / root mean square of the residuals of its quantity."""
        squares = np.mean(residuals**2, axis=0)
        owners = np.array(self.owners)
        means = [squares[owners == number].mean() for number in range(len(self.quantities))]
        weights: Array = 1 / np.sqrt(np.maximum(np.array(means)[owners], 1e-30))
        return weights


def time_window(table: Table, name: str, begin: float, end: float) -> tuple[Array, Array]:
    """Return times [s] and values of a column between two times [s], both of shape (n,)."""
    times, values = np.array(table.columns[TIME]), np.array(table.columns[name])
    kept = (times >= begin) & (times <= end)
    return times[kept], values[kept]


def measurement(table: Table, scene: Scene, chosen: Sequence[str]) -> Measurement:
    """Return columns of a table as a measurement of a scene: `chosen`, or all but the time.

    Columns are named as `somo run` names them, with or without the name of the manipulator.
    Raises InvalidFile with every column that the scene cannot record.
    """
    whole = make_plan(scene_recording(scene, MEASURABLE))
    header = columns.header(whole.recorded)
    full = {name: name for name in header} | {_short(name): name for name in header}
    wanted = _chosen_columns(table, header, full, chosen)
    problems = list(_problems(table, wanted, full))
    if problems:
        raise InvalidFile(problems, table.texts)
    names = [full[name] for name in wanted]
    groups = _quantities_by_name(whole.recorded)
    quantities = tuple(one for one in MEASURABLE if one in {groups[name] for name in names})
    own_header = columns.header(make_plan(scene_recording(scene, quantities)).recorded)
    return Measurement(
        names=tuple(names),
        times=np.array(table.columns[TIME]),
        values=np.array([table.columns[name] for name in wanted]).T,
        quantities=quantities,
        places=tuple(own_header.index(name) for name in names),
        owners=tuple(quantities.index(groups[name]) for name in names),
    )


def _chosen_columns(
    table: Table, header: Sequence[str], full: Mapping[str, str], chosen: Sequence[str]
) -> list[str]:
    """Return the names in the table of the chosen columns, or of all but the time."""
    if not chosen:
        return [name for name in table.names if name != TIME]
    # the table and `chosen` may each have a name with or without the manipulator
    short = {name: _short(name) for name in header}
    spellings = {name: {name, full.get(name, name), short.get(name, name)} for name in chosen}
    require_columns(table, [name for name in chosen if spellings[name].isdisjoint(table.names)])
    return [next(one for one in table.names if one in spellings[name]) for name in chosen]


def _quantities_by_name(recorded: columns.Recorded) -> dict[str, Quantity]:
    """Return the quantity of every column by its name."""
    groups: dict[str, Quantity] = {
        name: group.quantity
        for group in columns.body_column_groups(recorded)
        for name in group.selection.names
    }
    # an object records its pose alone, which is measured like the pose of a base
    for of_object in columns.object_column_groups(recorded):
        groups |= dict.fromkeys(of_object.selection.names, "base_pose")
    return groups


def scene_recording(scene: Scene, quantities: tuple[Quantity, ...]) -> Scene:
    """Return the scene recording these quantities and the poses of objects, and nothing else.

    It has no stop conditions, so that a run lasts as long as the measurement.
    """
    return dataclasses.replace(
        scene,
        columns=quantities,
        object_quantities=("pose",),
        only=(),
        stop_conditions=(),
        has_contact_events=False,
    )


def _short(name: str) -> str:
    # without the name of the manipulator: the scene has one only
    return name.partition(".")[2]


def _problems(table: Table, wanted: Sequence[str], full: dict[str, str]) -> Iterator[Problem]:
    if not wanted:
        yield Problem(table.header_span(TIME), f"there is no column besides {TIME}")
    if table.columns[TIME][0] < 0:
        place = table.cell_span(0, TIME)
        hint = "times are counted from the start of the scene"
        yield Problem(place, f"time {table.columns[TIME][0]:g} s is before the start", hint)
    seen: dict[str, str] = {}
    for name in wanted:
        if name not in full:
            yield Problem(
                table.header_span(name),
                f"the scene records no column '{name}'",
                "name columns as somo run does, such as tip.x_m or actuator_0_joint_01.angle_rad, "
                "or choose those to fit with --columns",
            )
        elif full[name] in seen:
            message = f"'{name}' and '{seen[full[name]]}' are the same column"
            yield Problem(table.header_span(name), message)
        else:
            seen[full[name]] = name
