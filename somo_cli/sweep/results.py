"""The folder of a sweep: `study.json`, a journal of outcomes, the table, and logs of what failed.

The journal takes a line as soon as a run ends, so that whatever ends the sweep loses the runs in
flight alone. The table is in the order of the runs, whatever the order in which they end.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO

from somo_cli import output_files
from somo_cli.problems import SomoError
from somo_cli.sweep.one_run import Outcome
from somo_cli.sweep.study import Study

TABLE, ABOUT, JOURNAL, LOG = "results.csv", "study.json", "runs.jsonl", "log.txt"
FILES = (TABLE, ABOUT, JOURNAL)
"""What a sweep writes into its folder, beside the numbered folders of runs."""


class OtherStudy(SomoError):
    """The folder has results of another study, or of this one before it was changed."""


class Results:
    """The results of a sweep in its folder, opened by `with`.

    `identity` is what a run depends on, as values for JSON. With `resumes` the runs of the journal
    count as done. Raises OSError, and OtherStudy.
    """

    def __init__(self, folder: str, study: Study, about: Mapping[str, Any], resumes: bool) -> None:
        self.folder = folder
        self._folder = Path(folder)
        self._study = study
        self._about = about
        self.outcomes: dict[int, Outcome] = {}
        """The outcomes so far, by the number of the run."""
        if resumes:
            self._take_up(self._folder)
        elif any((self._folder / name).exists() for name in FILES):
            raise OtherStudy(f"{folder} has results already: go on with --resume, or name another")
        self._journal: TextIO | None = None
        self._table: TextIO | None = None
        self._in_table = 0

    def __enter__(self) -> Results:
        self._folder.mkdir(parents=True, exist_ok=True)
        text = json.dumps(self._about, indent=2) + "\n"
        output_files.write_atomically(str(self._folder / ABOUT), text)
        # a line that was cut when the last sweep was killed goes
        lines = [_line(number, outcome) for number, outcome in self.outcomes.items()]
        output_files.write_atomically(str(self._folder / JOURNAL), "".join(lines))
        self._journal = (self._folder / JOURNAL).open("a", encoding="utf-8")
        self._table = (self._folder / TABLE).open("w", encoding="utf-8", newline="")
        self._table.write(self._csv([self._study.header]))
        self._extend_table()
        return self

    def __exit__(self, *_: object) -> None:
        if self._journal is not None:
            self._journal.close()
        if self._table is not None:
            self._table.close()
            # after an interrupt runs are missing, and those after them have waited
            text = self._csv([self._study.header, *map(self._row, sorted(self.outcomes))])
            output_files.write_atomically(str(self._folder / TABLE), text)

    @property
    def failures(self) -> int:
        """The number of runs that failed."""
        return sum(not one.is_good for one in self.outcomes.values())

    def taking(self, folders: Sequence[str]) -> Results:
        """Add the results of other folders of the same study. Raises OtherStudy and OSError."""
        for folder in folders:
            if not (Path(folder) / ABOUT).exists():
                raise OtherStudy(f"{folder} has no results of a sweep")
            self._take_up(Path(folder))
        return self

    def forget_failures(self) -> None:
        """Have the runs that failed done again."""
        self.outcomes = {n: one for n, one in self.outcomes.items() if one.is_good}

    def add(self, number: int, outcome: Outcome) -> None:
        """Keep the outcome of a run. Raises OSError."""
        assert self._journal is not None
        self.outcomes[number] = outcome
        self._journal.write(_line(number, outcome))
        self._journal.flush()
        if outcome.log:
            folder = self._folder / f"{number:04d}"
            folder.mkdir(exist_ok=True)
            output_files.write_atomically(str(folder / LOG), outcome.log + "\n")
        self._extend_table()

    def _extend_table(self) -> None:
        """Write the rows that follow those in the table."""
        assert self._table is not None
        while self._in_table in self.outcomes:
            self._table.write(self._csv([self._row(self._in_table)]))
            self._in_table += 1
        self._table.flush()

    def _row(self, number: int) -> tuple[object, ...]:
        return row_of(self._study, number, self.outcomes[number])

    @staticmethod
    def _csv(rows: list[tuple[object, ...]] | list[tuple[str, ...]]) -> str:
        stream = io.StringIO()
        csv.writer(stream, lineterminator="\n").writerows(rows)
        return stream.getvalue()

    def _take_up(self, folder: Path) -> None:
        """Read the journal of a folder with results of this study."""
        about = folder / ABOUT
        if not about.exists():
            return
        try:
            before = json.loads(about.read_text("utf-8"))["identity"]
        except (ValueError, KeyError, TypeError) as error:
            raise OtherStudy(f"{about} is not the file of a sweep") from error
        changed = _differences(before, self._about["identity"])
        if changed:
            raise OtherStudy(f"{folder} has results of another study: {', '.join(changed)}")
        for line in (folder / JOURNAL).read_text("utf-8", "replace").splitlines():
            read = _read_line(line)
            if read is not None and read[0] < len(self._study.points):
                self.outcomes[read[0]] = read[1]


def row_of(study: Study, number: int, outcome: Outcome) -> tuple[object, ...]:
    """Return a row of the table, in the order of `Study.header`."""
    point = study.points[number]
    parameters = (_text(point[one.name]) for one in study.parameters)
    labels = (_text(outcome.labels.get(one.name, "")) for one in study.labels if not one.is_series)
    run_time = round(outcome.run_time, 6) if outcome.run_time else ""
    errors = (_text(outcome.labels.get(name, "")) for name in study.errors)
    ending = (outcome.status, " ".join(outcome.findings), outcome.reason, run_time)
    return (number, *parameters, *labels, *errors, *ending)


def _text(value: object) -> object:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return "" if math.isnan(value) else repr(value)
    return value if isinstance(value, int | str) else json.dumps(value)


def _line(number: int, outcome: Outcome) -> str:
    data = {
        "run": number,
        "status": outcome.status,
        "labels": outcome.labels,
        "findings": outcome.findings,
        "reason": outcome.reason,
        "run_time": outcome.run_time,
        "log": outcome.log,
    }
    return json.dumps(data) + "\n"


def _read_line(line: str) -> tuple[int, Outcome] | None:
    """Return a run of the journal, None for a line that was cut."""
    try:
        data = json.loads(line)
        outcome = Outcome(
            data["status"],
            dict(data["labels"]),
            tuple(data["findings"]),
            data["reason"],
            data["run_time"],
            data["log"],
        )
        return int(data["run"]), outcome
    except (ValueError, KeyError, TypeError):
        return None


def _differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Return in words what differs between the identities of two studies."""
    found = []
    for key in dict.fromkeys([*before, *now]):
        old, new = before.get(key), now.get(key)
        if old == new:
            continue
        if isinstance(old, dict) and isinstance(new, dict):
            names = [name for name in dict.fromkeys([*old, *new]) if old.get(name) != new.get(name)]
            found.append(f"{key}: {', '.join(names)} changed")
        else:
            found.append(f"{key} changed")
    return found
