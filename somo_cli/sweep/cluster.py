"""Runs of a sweep on a Dask cluster; `distributed` is an extra, and known only here.

The scene travels to the workers with the files that it names, each run with its parameters, and
its outcome comes back with the trajectory, if that is kept. A worker that dies is the cluster's
affair: Dask gives its runs to others, and gives a run up that has taken three workers with it.
"""

from __future__ import annotations

import dataclasses
import tempfile
import threading
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from somo_cli import __version__, output_files
from somo_cli.problems import ClusterFailed, ExtraMissing
from somo_cli.sweep.one_run import Outcome, StudyRunner
from somo_cli.sweep.study import Point

Task = tuple[int, Point]
Returned = tuple[Outcome, dict[str, bytes]]

_IN_FLIGHT = 1000  # runs that the scheduler knows of at once
_CONNECTING = 30.0  # s


class ClusterPool:
    """Runs tasks on the cluster of a scheduler; to be used by `with`, as `Pool`.

    Raises ExtraMissing without `distributed`, and ClusterFailed.
    """

    def __init__(self, runner: StudyRunner, address: str) -> None:
        try:
            import distributed
        except ImportError as error:
            raise ExtraMissing(
                "a cluster needs distributed: pip install 'somo-cli[cluster]'"
            ) from error
        self._dask: Any = distributed
        self._folder = Path(runner.folder)
        self._runner = runner
        self._address = address
        self._client: Any = None

    def __enter__(self) -> ClusterPool:
        try:
            self._client = self._dask.Client(self._address, timeout=_CONNECTING)
            versions = self._client.run(_version)
        except (OSError, ValueError, TimeoutError) as error:
            raise ClusterFailed(f"{self._address}: {error or 'no answer'}") from error
        except ImportError as error:
            self.__exit__()
            message = f"{self._address}: a worker has no somo: install somo-cli {__version__} there"
            raise ClusterFailed(message) from error
        others = {worker: one for worker, one in versions.items() if one != __version__}
        if others:
            self.__exit__()
            worker, version = next(iter(others.items()))
            message = f"the worker {worker} has somo {version}, and this is {__version__}"
            raise ClusterFailed(f"{self._address}: {message}")
        return self

    def __exit__(self, *_: object) -> None:
        if self._client is not None:
            self._client.close()
            self._client = None

    def outcomes(self, tasks: Iterable[Task]) -> Iterator[tuple[int, Outcome]]:
        """Yield the number and the outcome of every task, as they end."""
        client, waiting = self._client, iter(tasks)
        runner = client.scatter(self._runner, broadcast=True)
        numbers: dict[Any, int] = {}

        def submitted(count: int) -> list[Any]:
            futures = []
            for number, point in islice(waiting, count):
                future = client.submit(_run, runner, number, point, pure=False)
                numbers[future] = number
                futures.append(future)
            return futures

        running = self._dask.as_completed(submitted(_IN_FLIGHT))
        for future in running:
            number = numbers.pop(future)
            outcome, files = self._returned(future)
            for name, content in files.items():
                path = self._folder / name
                path.parent.mkdir(parents=True, exist_ok=True)
                output_files.write_atomically(str(path), content)
            running.update(submitted(1))
            yield number, outcome

    def _returned(self, future: Any) -> Returned:
        """Return what a run sent back, or that it was lost with its workers."""
        try:
            returned: Returned = future.result()
        except self._dask.scheduler.KilledWorker as error:
            reason = "it took several workers of the cluster with it"
            return Outcome("crashed", reason=reason, log=str(error)), {}
        except self._dask.client.FutureCancelledError as error:
            message = f"{self._address}: the scheduler was lost"
            raise ClusterFailed(message) from error
        return returned


def _version() -> str:
    return __version__


def _run(runner: StudyRunner, number: int, point: Point) -> Returned:
    """Run a set on a worker; return its outcome, and the files that are kept by their names.

    One at a time: all engines of a process share a parameter of contact.
    """
    from distributed import get_worker

    lock = get_worker().__dict__.setdefault("_somo_lock", threading.Lock())
    with lock, tempfile.TemporaryDirectory(prefix="somo-") as folder:
        outcome = dataclasses.replace(runner, folder=folder).run(number, point)
        files = {
            str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(Path(folder).rglob("*"))
            if path.is_file()
        }
    return outcome, files
