"""A sweep from a file to its results: load the study and its scene, run what is missing."""

from __future__ import annotations

import dataclasses
import hashlib
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from somo_cli import __version__, files, loading
from somo_cli.document.parse import Document, parse
from somo_cli.document.table import Table, read_table
from somo_cli.packages import Access
from somo_cli.problems import InvalidFile, Pointer, Problem
from somo_cli.sweep import reader
from somo_cli.sweep.cluster import ClusterPool
from somo_cli.sweep.one_run import Outcome, StudyRunner
from somo_cli.sweep.pool import Pool
from somo_cli.sweep.results import Results
from somo_cli.sweep.study import Study


@dataclasses.dataclass(frozen=True, slots=True)
class LoadedStudy:
    """A study without errors, the document of its scene, and all texts that were read."""

    study: Study
    scene: Document
    texts: Mapping[str, str]
    about: Mapping[str, Any]
    access: Access
    warnings: Sequence[Problem] = ()
    """About the scene as it is written, before parameters are set."""

    def runner(self, folder: str) -> StudyRunner:
        """Return what runs its sets; trajectories go to the folder."""
        study = dataclasses.replace(self.study, points=())
        return StudyRunner(
            study, self.scene, folder, self.access.allow_outside, self.access.packages
        )


def load(path: str, sets: Sequence[str], access: Access) -> LoadedStudy:
    """Load a study with its scene and its table.

    `sets` override values of the scene. Raises InvalidFile with every error, and OSError.
    """
    document = parse(files.read_text(path), path)
    problems = reader.shape_problems(document)
    if problems:
        raise InvalidFile(problems, document.texts)
    data = cast(Mapping[str, Any], document.data)
    folder = Path(path).parent
    source, text = _named_file(document, ("scene",), path, access)
    scene = loading.as_scene(loading.load_text(text, source, sets, *access))
    found, warnings = loading.scene_of(scene)
    table = _table(document, data.get("combine"), path, access)
    study = reader.read_study(document, scene, found, table)
    texts = {**document.texts, **scene.texts, **({} if table is None else table.texts)}
    return LoadedStudy(
        study, scene, texts, _about(study, data, texts, sets, folder), access, warnings
    )


def run(
    loaded: LoadedStudy,
    results: Results,
    numbers: Sequence[int],
    workers: int,
    advance: Callable[[Results], None],
    scheduler: str | None = None,
) -> None:
    """Run the sets of these numbers that have no outcome, in worker processes or on a cluster.

    `advance` is called after each, with the results so far; `scheduler` is the address of a Dask
    scheduler. Raises OSError if results cannot be kept, and ClusterFailed.
    """
    study = loaded.study
    left = [number for number in numbers if number not in results.outcomes]
    if not left:
        return
    runner = loaded.runner(results.folder)
    with _pool(runner, min(workers, len(left)), study.time_out, scheduler) as pool:
        for number, outcome in pool.outcomes((one, study.points[one]) for one in left):
            results.add(number, outcome)
            advance(results)


def _pool(
    runner: StudyRunner, workers: int, time_out: float | None, scheduler: str | None
) -> Pool | ClusterPool:
    if scheduler is None:
        return Pool(runner, workers, time_out)
    return ClusterPool(runner, scheduler)


def check(loaded: LoadedStudy, workers: int, advance: Callable[[int], None]) -> dict[int, Outcome]:
    """Compile and check all sets without running them; return the outcomes by number."""
    found: dict[int, Outcome] = {}
    points = loaded.study.points
    with Pool(loaded.runner(""), min(workers, len(points)), None, only_checks=True) as pool:
        for number, outcome in pool.outcomes(enumerate(points)):
            found[number] = outcome
            advance(len(found))
    return found


def _named_file(document: Document, pointer: Pointer, path: str, access: Access) -> tuple[str, str]:
    """Return the source and the text of a file that the study names. Raises InvalidFile."""
    reference = str(document.at(pointer))
    try:
        return files.open_reference(path, reference, access.allow_outside)
    except OSError as error:
        message = f"'{reference}' cannot be read: {error.strerror or error}"
    except ValueError as error:
        message = f"'{reference}' cannot be used: {error}"
    raise InvalidFile([Problem(document.span(pointer), message)], document.texts)


def _table(document: Document, combine: object, path: str, access: Access) -> Table | None:
    if not isinstance(combine, dict):
        return None
    source, text = _named_file(document, ("combine", "table"), path, access)
    return read_table(text, source)


def _about(
    study: Study,
    data: Mapping[str, Any],
    texts: Mapping[str, str],
    sets: Sequence[str],
    folder: Path,
) -> dict[str, Any]:
    """Return the contents of `study.json`: what was run, and all that its results depend on."""
    inputs = {
        os.path.relpath(source, folder): hashlib.sha256(
            text.encode("utf-8", "surrogateescape")
        ).hexdigest()
        for source, text in texts.items()
        if not source.startswith("--set")
    }
    study_keys = {key: value for key, value in data.items() if key not in ("keep", "time_out")}
    # the study's own text is in its values: comments may change
    study_name = next(iter(inputs))
    del inputs[study_name]
    return {
        "identity": {
            "somo": __version__,
            "study": study_keys,
            "inputs": inputs,
            "overrides": list(sets),
        },
        "study": study_name,
        "runs": len(study.points),
        "parameters": [
            {"name": one.name, "spacing": one.spacing, "values": list(one.values)}
            if one.bounds is None
            else {"name": one.name, "spacing": one.spacing, "bounds": list(one.bounds)}
            for one in study.parameters
        ],
        "labels": [
            {"name": one.name, "unit": one.unit} for one in study.labels if not one.is_series
        ],
        "data": dict(data),
    }
