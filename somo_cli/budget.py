"""The time and memory that a command may use."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from somo_cli.problems import BudgetSpent

_MEGABYTE = 1e6  # bytes


class Budget:
    """Wall time [s] since it was made, and memory of the process [MB]; None is no bound.

    `clock` returns seconds, `memory` the most bytes that the process has had in memory.
    """

    def __init__(
        self,
        max_seconds: float | None = None,
        max_memory: float | None = None,
        clock: Callable[[], float] = time.monotonic,
        memory: Callable[[], float] | None = None,
    ) -> None:
        self._max_seconds = max_seconds
        self._max_memory = max_memory
        self._clock = clock
        self._memory = memory or most_memory
        self._start = clock()

    def check(self, progress: str) -> None:
        """Raise BudgetSpent if more than the budget is used; `progress` says how far the work is.

        Takes a microsecond, so that it can be called between any two steps of work.
        """
        if self._max_seconds is not None and self._clock() - self._start > self._max_seconds:
            raise BudgetSpent(f"more than {self._max_seconds:g} s", "--max-seconds", progress)
        if self._max_memory is not None:
            used = self._memory() / _MEGABYTE
            if used > self._max_memory:
                reason = f"{used:.0f} MB of memory, more than {self._max_memory:g}"
                raise BudgetSpent(reason, "--max-memory", progress)


def most_memory() -> float:
    """Return the most bytes that this process has had in memory; NaN where that is unknown."""
    if sys.platform == "win32":
        return float("nan")
    import resource

    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(most if sys.platform == "darwin" else 1024 * most)
