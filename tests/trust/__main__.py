"""Run random extreme contact scenes and print which are unphysical, and whether the run says so.

`make trust`; `python -m tests.trust COUNT SEED` for others. Ends with 1 if any is silent, or if a
shipped scene has a finding: that would be a false alarm.
"""

from __future__ import annotations

import os
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor

from tests.trust.judge import outcome
from tests.trust.scenes import random_scenes
from tests.trust.shipped import shipped_findings

COUNT = 100
SEED = 1
SHIPPED_TIME = 4.0  # s


def main(count: int = COUNT, seed: int = SEED) -> int:
    """Return the exit code."""
    scenes = random_scenes(count, seed)
    with ProcessPoolExecutor(initializer=_hush) as processes:
        outcomes = list(processes.map(outcome, scenes))
    for one in outcomes:
        if one.codes or one.unphysical:
            print(
                f"{one.name:14}{1e3 * one.time_step:>6g} ms  found: {', '.join(one.codes) or '-'}"
                f"  unphysical: {', '.join(one.unphysical) or '-'}"
            )
    ends = Counter("diverged" if one.end == "diverged" else _kind(one.codes) for one in outcomes)
    silent = [one.name for one in outcomes if one.is_silent]
    print(f"{len(outcomes)} scenes: " + ", ".join(f"{n} {kind}" for kind, n in ends.items()))
    print(f"unphysical and silent: {', '.join(silent) or 'none'}")
    alarms = shipped_findings(SHIPPED_TIME)
    print(f"findings of shipped scenes in {SHIPPED_TIME:g} s: {', '.join(alarms) or 'none'}")
    return int(bool(silent or alarms))


def _kind(codes: tuple[str, ...]) -> str:
    return "with findings" if codes else "without findings"


def _hush() -> None:
    """Drop what the engine has to say."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
