"""What a CSV lacks that a picture needs, and whether a new simulation agrees with it."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from somo_cli.problems import Problem

if TYPE_CHECKING:
    from somo_cli.document.table import Table
    from somo_cli.picture.recorded_motion import RecordedMotion

AGREEMENT = 1e-9  # of the range of a column
_KINDS = {
    ".angle_rad": ("joint angles", "*.angle_rad"),
    ".base_pose.": ("base pose", "*.base_pose.*"),
    ".pose.": ("pose", "*.pose.*"),
}


class Repetition(NamedTuple):
    """How a recorded run is repeated: scene, overrides, time step and end [s], and its CSV."""

    scene: str
    sets: Sequence[str]
    time_step: float | None
    end: float
    output: str

    def command(self, patterns: Sequence[str]) -> str:
        """Return the command that records these columns, as a shell needs it."""
        words = ["somo", "run", self.scene, "--duration", f"{self.end:.9g}"]
        if self.time_step is not None:
            words += ["--time-step", f"{self.time_step!r}"]
        for one in self.sets:
            words += ["--set", one]
        for one in patterns:
            words += ["--record", one]
        return shlex.join([*words, "-o", self.output])


def missing_columns(recording: RecordedMotion) -> list[str]:
    """Return the names of the columns that a picture needs and a recording lacks."""
    return [name for name in recording.required_columns() if name not in recording.columns]


def problem_of(
    missing: Sequence[str], recording: RecordedMotion, table: Table, run: Repetition
) -> Problem:
    """Return the problem of a CSV that lacks columns: which, and the command that records all."""
    kinds = {name: next(kind for kind in _KINDS if kind in name) for name in missing}
    lacking: dict[str, dict[str, None]] = {}
    for name, kind in kinds.items():
        lacking.setdefault(_KINDS[kind][0], {})[_owner(name, recording)] = None
    parts = [f"{what} of {', '.join(owners)}" for what, owners in lacking.items()]
    message = (
        f"it has no {'; no '.join(parts)}, such as '{missing[0]}', so the configuration is unknown"
    )
    wanted = recording.required_columns()
    patterns = [_KINDS[kind][1] for kind in _KINDS if any(kind in name for name in wanted)]
    hint = f"simulate it again with --simulate, or record it: {run.command(patterns)}"
    return Problem(table.header_span(table.names[0]), message, hint)


def difference_lines(recording: RecordedMotion, again: RecordedMotion) -> Iterator[str]:
    """Yield a warning if a new simulation is not what was recorded, in the columns of both."""
    rows = {time: row for row, time in enumerate(again.times)}
    pairs = [(row, rows[time]) for row, time in enumerate(recording.times) if time in rows]
    worst, most = "", AGREEMENT
    for name, values in recording.columns.items():
        others = again.columns.get(name)
        size = max(values) - min(values)
        if others is None or name == "time_s" or not pairs:
            continue
        off = max(abs(values[row] - others[other]) for row, other in pairs)
        share = off / size if size else float(off > 0)
        if share > most:
            worst, most = name, share
    if worst:
        yield (
            f"somo: warning: this simulation is not the one that was recorded: {worst} differs "
            f"by {100 * most:.2g} % of its range"
        )
        yield "  hint: the scene, an option of the run or a version has changed since"


def _owner(name: str, recording: RecordedMotion) -> str:
    """Return which manipulator or object a column belongs to; names may contain points."""
    scene = recording.scene
    known = [one.name for one in scene.manipulators] + [one.name for one in scene.objects]
    return max((one for one in known if name.startswith(f"{one}.")), key=len)
